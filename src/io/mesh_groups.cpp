#include "io/mesh_groups.h"

#include <set>
#include <utility>

#include "io/number_text.h"
#include "io/set_names.h"

namespace anatomesh {
namespace {

std::string spoken_name(const Interface& surface, const std::map<Label, std::string>& names) {
  const std::string& inside = names.at(surface.inside);
  return surface.outside == 0 ? inside + "_skin" : inside + "_to_" + names.at(surface.outside);
}

std::string numbered_name(const Interface& surface) {
  const std::string inside = number_text(surface.inside);
  return surface.outside == 0 ? "skin_of_" + inside : "interface_" + inside + "_" + number_text(surface.outside);
}

/// Numbers that are no label, ascending.
class FreeTags {
 public:
  FreeTags(const std::map<Label, std::string>& labels, std::size_t count) : labels_(labels) {
    const Label largest = labels.empty() ? 0 : labels.rbegin()->first;
    if (largest < kLargestGroup && count <= kLargestGroup - largest) last_ = largest;
  }

  Label next() {
    do ++last_;
    while (labels_.contains(last_));
    return last_;
  }

 private:
  const std::map<Label, std::string>& labels_;
  Label last_ = 0;
};

}  // namespace

MeshGroups mesh_groups(const TetMesh& mesh, std::size_t most_bytes) {
  MeshGroups groups{set_names(mesh, {.most_bytes = most_bytes}), {}};
  std::vector<Interface> surfaces = interfaces_of(mesh);
  std::set<std::string> taken;
  for (const auto& [label, name] : groups.tissues) taken.insert(name);
  FreeTags tags(groups.tissues, surfaces.size());
  for (Interface& surface : surfaces) {
    std::string name = spoken_name(surface, groups.tissues);
    if (name.size() > most_bytes || taken.contains(name)) name = numbered_name(surface);
    while (!taken.insert(name).second) name += '_';
    groups.surfaces.push_back({tags.next(), std::move(name), std::move(surface)});
  }
  return groups;
}

}  // namespace anatomesh
