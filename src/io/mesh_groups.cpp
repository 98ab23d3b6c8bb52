#include "io/mesh_groups.h"

#include <utility>

#include "io/interface_names.h"
#include "io/set_names.h"

namespace anatomesh {
namespace {

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
  InterfaceNames names(groups.tissues, most_bytes);
  FreeTags tags(groups.tissues, surfaces.size());
  for (Interface& surface : surfaces) {
    std::string name = names.name_of(surface.inside, surface.outside);
    groups.surfaces.push_back({tags.next(), std::move(name), std::move(surface)});
  }
  return groups;
}

}  // namespace anatomesh
