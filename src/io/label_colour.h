// Colours of labels as texts.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "anatomesh/label_table.h"

namespace anatomesh {

/// "#ff8000".
std::string colour_text(const Colour& colour);

/// Nothing where the text is no such colour.
std::optional<Colour> colour_from(std::string_view text);

}  // namespace anatomesh
