#include "anatomesh/label_list.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <iterator>
#include <set>
#include <unordered_map>

#include "anatomesh/errors.h"

namespace anatomesh {
namespace {

/// The texts in one.
std::string joined(std::initializer_list<std::string_view> texts) {
  std::string all;
  for (const std::string_view text : texts) all.append(text);
  return all;
}

}  // namespace

LabelCounts count_labels(const LabelImage& image) {
  std::unordered_map<Label, std::uint64_t> counts;
  for (auto begin = image.voxels.begin(); begin != image.voxels.end();) {
    const auto end = std::find_if(begin, image.voxels.end(), [&](Label label) { return label != *begin; });
    counts[*begin] += static_cast<std::uint64_t>(end - begin);
    begin = end;
  }
  counts.erase(0);
  return {counts.begin(), counts.end()};
}

Label parse_label(std::string_view text) {
  Label label = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), label);
  if (error != std::errc() || end != text.data() + text.size() || label == 0)
    throw InvalidOption(joined({"'", text, "' is not a label; a label is a whole number from 1 to 4294967295"}));
  return label;
}

std::vector<LabelRange> parse_label_list(std::string_view text) {
  std::vector<LabelRange> ranges;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view item = text.substr(begin, end - begin);
    const std::size_t dash = item.find('-');
    LabelRange range;
    range.first = parse_label(item.substr(0, dash));
    range.last = dash == std::string_view::npos ? range.first : parse_label(item.substr(dash + 1));
    if (range.last < range.first)
      throw InvalidOption(joined({"the range '", item, "' runs backwards; write it as ", std::to_string(range.last),
                                  "-", std::to_string(range.first)}));
    ranges.push_back(range);
    begin = end + 1;
  }
  return ranges;
}

std::vector<Label> select_labels(const std::vector<LabelRange>& ranges, const LabelCounts& present,
                                 std::string_view option) {
  std::set<Label> selected;
  for (const auto& [first, last] : ranges) {
    if (first == last) require_label(first, present, option);
    const auto begin = present.lower_bound(first), end = present.upper_bound(last);
    if (begin == end)
      throw InvalidOption(joined({option, ": the image has no label in ", std::to_string(first), "-",
                                  std::to_string(last), "; it has ", shortened(present)}));
    std::transform(begin, end, std::inserter(selected, selected.end()), [](const auto& entry) { return entry.first; });
  }
  return {selected.begin(), selected.end()};
}

void require_label(Label label, const LabelCounts& present, std::string_view option) {
  if (present.contains(label)) return;
  throw InvalidOption(
      joined({option, ": the image has no label ", std::to_string(label), "; it has ", shortened(present)}));
}

std::string shortened(const LabelCounts& labels) {
  constexpr std::size_t kShown = 12;
  if (labels.empty()) return "none";
  std::string list;
  std::size_t shown = 0;
  for (const auto& [label, count] : labels) {
    if (shown == kShown) break;
    list.append(shown++ == 0 ? "" : ", ").append(std::to_string(label));
  }
  if (labels.size() > shown) list.append(" and ").append(std::to_string(labels.size() - shown)).append(" more");
  return list;
}

}  // namespace anatomesh
