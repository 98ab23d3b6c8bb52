// The number types that voxels of a file may have.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>

#include "io/label_values.h"

namespace anatomesh {

enum class NumberType { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };

/// A linear map of the values in the file, as some formats have it; by default none.
struct ValueScale {
  double slope = 1;
  double offset = 0;
  bool is_identity() const { return slope == 1 && offset == 0; }
};

/// Size of a number in bytes.
std::size_t bytes_of(NumberType type);

/// Turns the byte order of count values round.
void swap_bytes(std::byte* values, std::size_t count, std::size_t value_bytes);

/// As store_labels<Value>() in label_values.h.
std::optional<BadLabel> store_labels(NumberType type, const void* values, std::size_t count, Label* labels);

/// A piece of an image, for messages: where its first voxel stands in which image.
struct VoxelPlace {
  const std::filesystem::path& path;
  std::array<std::size_t, 3> size;
  std::size_t first = 0;
};

/// Turns count values, at any alignment, into labels. values and labels may be the same memory where a value
/// is as large as a label. Throws InvalidInput naming the first voxel whose value is no label.
void store_voxels(const VoxelPlace& place, NumberType type, const ValueScale& scale, const void* values,
                  std::size_t count, Label* labels);

}  // namespace anatomesh
