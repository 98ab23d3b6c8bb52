// Labels as a user writes them, and as an image has them.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/label_image.h"
#include "anatomesh/types.h"

namespace anatomesh {

/// Voxels of each label of an image, without the background.
using LabelCounts = std::map<Label, std::uint64_t>;

LabelCounts count_labels(const LabelImage& image);

/// First and last label of a range.
struct LabelRange {
  Label first = 0;
  Label last = 0;
};

/// One label, 1 to 2^32 - 1. Throws InvalidOption.
Label parse_label(std::string_view text);

/// A list such as "1,2,5-9". Throws InvalidOption when it is malformed.
std::vector<LabelRange> parse_label_list(std::string_view text);

/// The labels of the image that the ranges name, ascending. Throws InvalidOption when a range names none; `option` is
/// where the user wrote them.
std::vector<Label> select_labels(const std::vector<LabelRange>& ranges, const LabelCounts& present,
                                 std::string_view option);

/// Throws InvalidOption unless the image has the label; `option` is where the user wrote it.
void require_label(Label label, const LabelCounts& present, std::string_view option);

/// "1, 2, 3, 7, 9, 12, 13, 14 and 108 more".
std::string shortened(const LabelCounts& labels);

}  // namespace anatomesh
