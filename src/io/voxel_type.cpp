#include "io/voxel_type.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "anatomesh/errors.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

template <typename Value>
std::optional<BadLabel> store_scaled_labels(const void* values, std::size_t count, const ValueScale& scale,
                                            Label* labels) {
  const auto* bytes = static_cast<const std::byte*>(values);
  for (std::size_t n = 0; n < count; ++n) {
    Value value;
    std::memcpy(&value, bytes + n * sizeof(Value), sizeof(Value));
    const double scaled = scale.slope * static_cast<double>(value) + scale.offset;
    if (const auto bad = store_labels<double>(&scaled, 1, labels + n)) return BadLabel{n, bad->value};
  }
  return std::nullopt;
}

/// What to do with the values of one type.
struct NumberFunctions {
  std::size_t bytes;
  std::optional<BadLabel> (*store)(const void* values, std::size_t count, Label* labels);
  std::optional<BadLabel> (*store_scaled)(const void* values, std::size_t count, const ValueScale& scale,
                                          Label* labels);
};

template <typename Value>
constexpr NumberFunctions functions_for() {
  return {sizeof(Value), &store_labels<Value>, &store_scaled_labels<Value>};
}

/// In the order of NumberType.
constexpr std::array kFunctions = {functions_for<std::uint8_t>(),  functions_for<std::int8_t>(),
                                   functions_for<std::uint16_t>(), functions_for<std::int16_t>(),
                                   functions_for<std::uint32_t>(), functions_for<std::int32_t>(),
                                   functions_for<std::uint64_t>(), functions_for<std::int64_t>(),
                                   functions_for<float>(),         functions_for<double>()};

const NumberFunctions& functions_of(NumberType type) { return kFunctions[static_cast<std::size_t>(type)]; }

}  // namespace

std::size_t bytes_of(NumberType type) { return functions_of(type).bytes; }

void swap_bytes(std::byte* values, std::size_t count, std::size_t value_bytes) {
  for (std::size_t n = 0; n < count; ++n) std::reverse(values + n * value_bytes, values + (n + 1) * value_bytes);
}

std::optional<BadLabel> store_labels(NumberType type, const void* values, std::size_t count, Label* labels) {
  return functions_of(type).store(values, count, labels);
}

void store_voxels(const VoxelPlace& place, NumberType type, const ValueScale& scale, const void* values,
                  std::size_t count, Label* labels) {
  const NumberFunctions& functions = functions_of(type);
  const auto bad = scale.is_identity() ? functions.store(values, count, labels)
                                       : functions.store_scaled(values, count, scale, labels);
  if (!bad) return;
  const std::size_t at = place.first + bad->position;
  const std::string index = number_text(at % place.size[0]) + ", " + number_text(at / place.size[0] % place.size[1]) +
                            ", " + number_text(at / place.size[0] / place.size[1]);
  throw InvalidInput("voxel (" + index + ") of " + in_quotes(place.path) + " has the value " + bad->value + "; " +
                     kLabelRule);
}

}  // namespace anatomesh
