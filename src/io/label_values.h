// From the numbers in a file to labels, exactly.
#pragma once

#include <cstddef>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

#include "anatomesh/types.h"
#include "io/number_text.h"

namespace anatomesh {

/// Said in messages about values that are none.
inline constexpr const char* kLabelRule = "labels must be whole numbers from 0 to 4294967295";

/// A value that is no label.
struct BadLabel {
  std::size_t position;
  std::string value;
};

/// Whether the value is a whole number from 0 to 2^32 - 1; NaN is not.
template <typename Value>
bool is_label(Value value) {
  constexpr auto most = std::numeric_limits<Label>::max();
  if constexpr (std::is_floating_point_v<Value>) {
    return value >= 0 && static_cast<double>(value) <= most && value == static_cast<Value>(static_cast<Label>(value));
  } else if constexpr (std::is_signed_v<Value>) {
    return value >= 0 && static_cast<std::make_unsigned_t<Value>>(value) <= most;
  } else {
    return value <= most;
  }
}

/// Turns count values of one type, at any alignment, into labels and returns the first that is none, if
/// any. values and labels may be the same memory where a value is as large as a label.
template <typename Value>
std::optional<BadLabel> store_labels(const void* values, std::size_t count, Label* labels) {
  if constexpr (std::is_same_v<Value, Label>) {
    if (values != labels) std::memcpy(labels, values, count * sizeof(Label));
    return std::nullopt;
  }
  const auto* bytes = static_cast<const std::byte*>(values);
  for (std::size_t n = 0; n < count; ++n) {
    Value value;
    std::memcpy(&value, bytes + n * sizeof(Value), sizeof(Value));
    if (!is_label(value)) return BadLabel{n, number_text(value)};
    const auto label = static_cast<Label>(value);  // NOLINT(bugprone-signed-char-misuse): it is not negative
    std::memcpy(labels + n, &label, sizeof(Label));
  }
  return std::nullopt;
}

}  // namespace anatomesh
