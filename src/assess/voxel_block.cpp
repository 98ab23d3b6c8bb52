#include "assess/voxel_block.h"

#include <algorithm>
#include <span>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace anatomesh::assess_detail {
namespace {

/// Voxels begin to end (exclusive) of a row; its place in the list of all runs is its number.
struct Run {
  std::int32_t begin, end;
};

/// The runs of every row, and where each row's begin.
struct Runs {
  explicit Runs(const VoxelBlock& block) {
    const std::uint8_t* voxel = block.inside.data();
    first_of_row.reserve(static_cast<std::size_t>(block.size[1] * block.size[2]) + 1);
    for (std::int64_t row = 0; row < block.size[1] * block.size[2]; ++row, voxel += block.size[0]) {
      first_of_row.push_back(runs.size());
      for (auto i = static_cast<std::int32_t>(0); i < block.size[0]; ++i) {
        if (!voxel[i]) continue;
        Run run = {i, i + 1};
        while (voxel[run.end]) ++run.end;  // ends in the padding
        runs.push_back(run);
        i = run.end;
      }
    }
    first_of_row.push_back(runs.size());
  }

  std::vector<Run> runs;
  std::vector<std::size_t> first_of_row;
};

/// Joins runs of two rows that overlap, or come within `reach` voxels of it.
void join_rows(const Runs& all, std::size_t row, std::size_t other, std::int32_t reach, DisjointSets& sets) {
  std::size_t a = all.first_of_row[row], b = all.first_of_row[other];
  while (a < all.first_of_row[row + 1] && b < all.first_of_row[other + 1]) {
    const Run x = all.runs[a], y = all.runs[b];
    if (x.begin < y.end + reach && y.begin < x.end + reach) {
      sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
    }
    (x.end < y.end ? a : b)++;
  }
}

struct RowStep {
  std::int64_t j, k;
};

/// Parts, when a row's runs touch those of the rows at these steps, and at most `reach` voxels further along the row.
std::uint64_t count_components(const VoxelBlock& block, std::span<const RowStep> steps, std::int32_t reach) {
  const Runs all(block);
  DisjointSets sets(all.runs.size());
  // The outermost rows are padding.
  for (std::int64_t k = 1; k + 1 < block.size[2]; ++k) {
    for (std::int64_t j = 1; j + 1 < block.size[1]; ++j) {
      for (const RowStep& s : steps) {
        join_rows(all, static_cast<std::size_t>(j + block.size[1] * k),
                  static_cast<std::size_t>(j + s.j + block.size[1] * (k + s.k)), reach, sets);
      }
    }
  }
  return sets.count_sets();
}

/// What the corner shared by 2x2x2 voxels, and the edges, sides and voxel that start at it in positive direction, add
/// to the Euler number. Bit i + 2 j + 4 k of the index: voxel (i, j, k) is inside, (1, 1, 1) being the positive one.
constexpr std::array<std::int8_t, 256> make_euler_table() {
  std::array<std::int8_t, 256> table = {};
  constexpr std::array<unsigned, 3> kPositive = {0b10101010, 0b11001100, 0b11110000};  // along i, j, k
  for (unsigned voxels = 0; voxels < 256; ++voxels) {
    int euler = voxels != 0;
    for (std::size_t a = 0; a < 3; ++a) {
      euler -= (voxels & kPositive[a]) != 0;                           // edge along a
      euler += (voxels & kPositive[a] & kPositive[(a + 1) % 3]) != 0;  // side that spans a and the next axis
    }
    euler -= (voxels & 0b10000000) != 0;
    table[voxels] = static_cast<std::int8_t>(euler);
  }
  return table;
}

constexpr auto kEuler = make_euler_table();

/// Sum over the corners between two rows and the two above them.
std::int64_t euler_of_rows(const std::uint8_t* row, std::int64_t to_next_row, std::int64_t to_next_slice,
                           std::int64_t size) {
  std::int64_t sum = 0;
  unsigned voxels = 0;  // those with i = 1 become those with i = 0 at the next corner
  for (std::int64_t i = 0; i < size; ++i) {
    const std::uint8_t* v = row + i;
    voxels = ((voxels >> 1) & 0b01010101u) | unsigned{v[0]} << 1 | unsigned{v[to_next_row]} << 3 |
             unsigned{v[to_next_slice]} << 5 | unsigned{v[to_next_row + to_next_slice]} << 7;
    sum += kEuler[voxels];
  }
  return sum;
}

}  // namespace

VoxelBlock cut_out(const LabelImage& image, const VoxelRange& range, Label label) {
  VoxelBlock block;
  for (std::size_t a = 0; a < 3; ++a) {
    block.first[a] = range.low[a] - VoxelBlock::kPad;
    block.size[a] = range.high[a] - range.low[a] + 1 + 2 * VoxelBlock::kPad;
  }
  block.inside.assign(static_cast<std::size_t>(block.size[0] * block.size[1] * block.size[2]), 0);
  const std::int64_t length = range.high[0] - range.low[0] + 1;
  parallel_for(
      static_cast<std::size_t>(range.high[2] - range.low[2] + 1),
      [&](std::size_t slice) {
        const std::int64_t k = range.low[2] + static_cast<std::int64_t>(slice);
        for (std::int64_t j = range.low[1]; j <= range.high[1]; ++j) {
          const Label* from =
              &image
                   .voxels[static_cast<std::size_t>(range.low[0]) +
                           image.size[0] * (static_cast<std::size_t>(j) + image.size[1] * static_cast<std::size_t>(k))];
          std::uint8_t* to = &block.inside[block.offset(VoxelBlock::kPad, j - block.first[1], k - block.first[2])];
          if (label == 0) {
            std::transform(from, from + length, to, [](Label l) { return static_cast<std::uint8_t>(l != 0); });
          } else {
            std::transform(from, from + length, to, [label](Label l) { return static_cast<std::uint8_t>(l == label); });
          }
        }
      },
      8);
  return block;
}

std::uint64_t count_components_6(const VoxelBlock& block) {
  constexpr std::array<RowStep, 2> kSteps = {{{-1, 0}, {0, -1}}};
  return count_components(block, kSteps, 0);
}

std::uint64_t count_components_26(const VoxelBlock& block) {
  constexpr std::array<RowStep, 4> kSteps = {{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  return count_components(block, kSteps, 1);
}

std::int64_t euler_number(const VoxelBlock& block) {
  const std::int64_t to_next_slice = block.size[0] * block.size[1];
  const auto slices = static_cast<std::size_t>(block.size[2] - 1);
  return static_cast<std::int64_t>(parallel_sum(slices, 8, [&](std::size_t begin, std::size_t end) {
    std::int64_t sum = 0;
    for (std::size_t k = begin; k < end; ++k) {
      for (std::int64_t j = 0; j + 1 < block.size[1]; ++j) {
        sum += euler_of_rows(&block.inside[block.offset(0, j, static_cast<std::int64_t>(k))], block.size[0],
                             to_next_slice, block.size[0]);
      }
    }
    return static_cast<double>(sum);
  }));
}

}  // namespace anatomesh::assess_detail
