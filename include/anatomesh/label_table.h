// What labels stand for.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "anatomesh/types.h"

namespace anatomesh {

/// Red, green, blue, 0 to 255 each.
using Colour = std::array<std::uint8_t, 3>;

/// What one label stands for.
struct LabelEntry {
  std::string name;              ///< UTF-8, in one line; empty: not known
  std::optional<Colour> colour;  ///< nothing: not known
  bool operator==(const LabelEntry&) const = default;
};

/// Names and colours by label. Labels without an entry have neither.
using LabelTable = std::map<Label, LabelEntry>;

}  // namespace anatomesh
