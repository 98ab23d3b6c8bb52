// After Slicer's developer guide, "Segmentations" (slicer.readthedocs.io): keys SegmentN_ID, _Name, _Color, _LabelValue
// and _Layer. The extents are not needed: outside of them a segment has no voxels. Before Slicer 4.11 there were
// neither values nor layers: each segment had a layer of its own, in which it was 1.
#include "io/slicer_segments.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "anatomesh/errors.h"
#include "io/label_values.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/text_cursor.h"
#include "io/utf8.h"

namespace anatomesh {
namespace {

/// The keys of one segment.
struct SegmentKeys {
  const std::filesystem::path& path;
  const std::map<std::string, std::string>& all;
  std::string prefix;  ///< "Segment3_"

  const std::string* find(const char* key) const {
    const auto found = all.find(prefix + key);
    return found == all.end() ? nullptr : &found->second;
  }

  /// A whole number; otherwise where the key is not there. Throws InvalidInput.
  Label number(const char* key, Label otherwise) const {
    const std::string* const text = find(key);
    if (text == nullptr) return otherwise;
    const std::string_view bare = trimmed(*text);
    Label value = 0;
    const auto [end, error] = std::from_chars(bare.data(), bare.data() + bare.size(), value);
    if (!bare.empty() && error == std::errc() && end == bare.data() + bare.size()) return value;
    throw InvalidInput(in_quotes(path) + " has '" + *text + "' for " + prefix + key + "; " + kLabelRule);
  }
};

/// Three numbers from 0 to 1; nothing where they are not that, since a colour is but a hint.
std::optional<Colour> colour_from(std::string_view text) {
  constexpr double kMost = 255;
  Colour colour = {};
  for (std::uint8_t& part : colour) {
    text = trimmed(text);
    double value = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !(value >= 0 && value <= 1)) return std::nullopt;
    part = static_cast<std::uint8_t>(std::lround(kMost * value));
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return colour;
}

LabelEntry entry_of(const SegmentKeys& keys) {
  LabelEntry entry;
  for (const char* key : {"Name", "ID"}) {
    const std::string* const text = keys.find(key);
    if (text == nullptr || trimmed(*text).empty() || !is_one_line_of_utf8(*text)) continue;
    entry.name = trimmed(*text);
    break;
  }
  if (const std::string* const colour = keys.find("Color")) entry.colour = colour_from(*colour);
  return entry;
}

Segment segment_from(const SegmentKeys& keys, std::size_t own_layer, std::size_t layers) {
  Segment segment;
  segment.entry = entry_of(keys);
  segment.value = keys.number("LabelValue", 1);
  segment.layer = keys.number("Layer", static_cast<Label>(own_layer));
  if (segment.layer >= layers) {
    throw InvalidInput(in_quotes(keys.path) + " has " + keys.prefix + "Layer " + number_text(segment.layer) +
                       ", but its voxels have " + number_text(layers) + " layer" + (layers == 1 ? "" : "s") +
                       ", numbered from 0");
  }
  if (segment.value == 0) {
    throw InvalidInput(in_quotes(keys.path) + " has " + keys.prefix + "LabelValue 0; 0 is the background");
  }
  return segment;
}

void require_distinct_segments(const std::filesystem::path& path, const std::vector<Segment>& segments) {
  std::map<std::pair<std::size_t, Label>, const Segment*> seen;
  for (const Segment& segment : segments) {
    const auto [at, is_new] = seen.emplace(std::pair(segment.layer, segment.value), &segment);
    if (is_new) continue;
    throw InvalidInput(in_quotes(path) + " has the segments '" + at->second->entry.name + "' and '" +
                       segment.entry.name + "', both of value " + number_text(segment.value) + " in layer " +
                       number_text(segment.layer) + "; each needs a value or a layer of its own");
  }
}

/// Whether numbers had to be given.
bool number_segments(std::vector<Segment>& segments) {
  std::set<Label> values;
  for (const Segment& segment : segments) values.insert(segment.value);
  const bool are_distinct = values.size() == segments.size();
  for (std::size_t n = 0; n < segments.size(); ++n) {
    segments[n].label = are_distinct ? segments[n].value : static_cast<Label>(n + 1);
  }
  return !are_distinct;
}

std::string count_of_voxels(std::uint64_t count) {
  return number_text(count) + (count == 1 ? " voxel of " : " voxels of ");
}

}  // namespace

LabelTable SegmentList::names() const {
  LabelTable names;
  for (const Segment& segment : segments) names[segment.label] = segment.entry;
  return names;
}

SegmentList segments_of(const std::filesystem::path& path, const std::map<std::string, std::string>& keys,
                        std::size_t layers) {
  SegmentList list;
  for (std::size_t n = 0;; ++n) {
    const SegmentKeys own = {path, keys, std::string("Segment").append(number_text(n)).append("_")};
    if (own.find("ID") == nullptr && own.find("Name") == nullptr && own.find("LabelValue") == nullptr) break;
    const bool is_of_old = own.find("Layer") == nullptr && own.find("LabelValue") == nullptr;
    list.segments.push_back(segment_from(own, is_of_old ? n : 0, layers));
  }
  require_distinct_segments(path, list.segments);
  if (number_segments(list.segments)) {
    list.notes.push_back("segments of " + in_quotes(path) +
                         " have the same value in different layers; they are labelled 1 to " +
                         number_text(list.segments.size()) + " in the order of the file");
  }
  return list;
}

LayerMerger::LayerMerger(const std::vector<Segment>& segments, std::size_t layers) : segment_of_value_(layers) {
  for (const Segment& segment : segments) {
    segment_of_value_[segment.layer][segment.value] = labels_.size();
    labels_.push_back(segment.label);
  }
}

void LayerMerger::merge(const Label* values, std::size_t voxels, Label* labels) {
  const std::size_t layers = segment_of_value_.size();
  for (std::size_t v = 0; v < voxels; ++v) {
    std::size_t last = 0, found = 0;
    bool is_unknown = false;
    for (std::size_t layer = 0; layer < layers; ++layer) {
      const Label value = values[v * layers + layer];
      if (value == 0) continue;
      const auto segment = segment_of_value_[layer].find(value);
      is_unknown = is_unknown || segment == segment_of_value_[layer].end();
      if (segment == segment_of_value_[layer].end()) continue;
      last = found++ == 0 ? segment->second : std::max(last, segment->second);
    }
    labels[v] = found == 0 ? 0 : labels_[last];
    overlapping_voxels_ += found > 1 ? 1 : 0;
    unknown_voxels_ += is_unknown ? 1 : 0;
  }
}

std::vector<std::string> LayerMerger::notes(const std::filesystem::path& path) const {
  std::vector<std::string> notes;
  if (overlapping_voxels_ > 0) {
    notes.push_back(count_of_voxels(overlapping_voxels_) + in_quotes(path) +
                    " are in more than one segment; the later segment has them");
  }
  if (unknown_voxels_ > 0) {
    notes.push_back(count_of_voxels(unknown_voxels_) + in_quotes(path) +
                    " have a value that no segment has; it is passed over");
  }
  return notes;
}

}  // namespace anatomesh
