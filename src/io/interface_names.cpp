#include "io/interface_names.h"

#include "io/number_text.h"
#include "io/text_cursor.h"

namespace anatomesh {
namespace {

std::string numbered_name(Label inside, Label outside) {
  const std::string first = number_text(inside);
  return outside == 0 ? "skin_of_" + first : "interface_" + first + "_" + number_text(outside);
}

}  // namespace

InterfaceNames::InterfaceNames(const std::map<Label, std::string>& tissues, std::size_t most_bytes)
    : tissues_(tissues), most_bytes_(most_bytes) {
  for (const auto& [label, name] : tissues) taken_.insert(in_small_letters(name));
}

std::string InterfaceNames::name_of(Label inside, Label outside) {
  std::string name = tissues_.at(inside);
  name += outside == 0 ? "_skin" : "_to_" + tissues_.at(outside);
  if (name.size() <= most_bytes_ && taken_.insert(in_small_letters(name)).second) return name;
  name = numbered_name(inside, outside);
  while (!taken_.insert(name).second) name += '_';
  return name;
}

}  // namespace anatomesh
