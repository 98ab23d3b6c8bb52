#include "image/tissue_image.h"

#include <algorithm>
#include <limits>
#include <string>
#include <unordered_map>

#include "anatomesh/errors.h"
#include "base/parallel.h"

namespace anatomesh {
namespace {

// Positions in the crop are 32-bit numbers.
constexpr double kMaxVoxels = 4e9;

struct Box {
  std::array<std::size_t, 3> lo, hi;  // inclusive
  bool empty = true;

  void add(std::size_t i0, std::size_t i1, std::size_t j, std::size_t k) {
    if (empty) lo = {i0, j, k}, hi = {i1, j, k};
    lo = {std::min(lo[0], i0), std::min(lo[1], j), std::min(lo[2], k)};
    hi = {std::max(hi[0], i1), std::max(hi[1], j), std::max(hi[2], k)};
    empty = false;
  }
  void add(const Box& other) {
    if (other.empty) return;
    add(other.lo[0], other.hi[0], other.lo[1], other.lo[2]);
    add(other.lo[0], other.hi[0], other.hi[1], other.hi[2]);
  }
};

// What one slice of the image holds: labels with their counts, and the box of its labelled voxels.
struct SliceContent {
  std::unordered_map<Label, std::uint64_t> counts;
  Box box;
};

SliceContent scan_slice(const LabelImage& image, const std::vector<Label>& chosen, std::size_t k) {
  SliceContent content;
  const auto wanted = [&](Label label) {
    return label != 0 && (chosen.empty() || std::binary_search(chosen.begin(), chosen.end(), label));
  };
  const std::size_t nx = image.size[0];
  for (std::size_t j = 0; j < image.size[1]; ++j) {
    const Label* row = &image.voxels[nx * (j + image.size[1] * k)];
    for (std::size_t begin = 0, end = 0; begin < nx; begin = end) {
      while (end < nx && row[end] == row[begin]) ++end;
      if (!wanted(row[begin])) continue;
      content.counts[row[begin]] += end - begin;
      content.box.add(begin, end - 1, j, k);
    }
  }
  return content;
}

std::unordered_map<Label, TissueId> number_labels(const std::unordered_map<Label, std::uint64_t>& counts,
                                                  TissueImage& tissues) {
  tissues.labels = {0};
  for (const auto& [label, count] : counts) tissues.labels.push_back(label);
  std::sort(tissues.labels.begin(), tissues.labels.end());
  tissues.counts.assign(tissues.labels.size(), 0);
  std::unordered_map<Label, TissueId> number;
  for (std::size_t t = 1; t < tissues.labels.size(); ++t) {
    number[tissues.labels[t]] = static_cast<TissueId>(t);
    tissues.counts[t] = counts.at(tissues.labels[t]);
  }
  return number;
}

void copy_row(const Label* from, TissueId* to, std::size_t n, const std::unordered_map<Label, TissueId>& number) {
  Label last = 0;
  TissueId tissue = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (from[i] != last) {
      last = from[i];
      const auto found = number.find(last);
      tissue = found == number.end() ? TissueId{0} : found->second;
    }
    to[i] = tissue;
  }
}

}  // namespace

TissueImage make_tissue_image(const LabelImage& image, const std::vector<Label>& chosen) {
  std::vector<Label> sorted = chosen;
  std::sort(sorted.begin(), sorted.end());
  std::vector<SliceContent> slices(image.size[2]);
  parallel_for(
      image.size[2], [&](std::size_t k) { slices[k] = scan_slice(image, sorted, k); }, 1);
  SliceContent all;
  for (const SliceContent& slice : slices) {
    for (const auto& [label, count] : slice.counts) all.counts[label] += count;
    all.box.add(slice.box);
  }
  if (all.box.empty) {
    if (!chosen.empty()) throw InvalidOption("no voxel of the image has one of the chosen labels");
    throw InvalidInput("the image holds background (0) only; at least one voxel must have a label");
  }
  if (all.counts.size() > std::numeric_limits<TissueId>::max())
    throw InvalidInput("the image has " + std::to_string(all.counts.size()) + " labels; at most 65535 are possible");

  TissueImage tissues;
  tissues.spacing_mm = image.spacing_mm;
  const auto number = number_labels(all.counts, tissues);
  double voxels = 1;
  for (std::size_t a = 0; a < 3; ++a)
    voxels *= static_cast<double>(all.box.hi[a] - all.box.lo[a] + 1 + 2 * TissueImage::kBorder);
  if (voxels > kMaxVoxels) {
    throw InvalidInput("the labelled part of the image has " + std::to_string(voxels) +
                       " voxels with its border; at most 4e9 are possible");
  }
  std::size_t total = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    tissues.whole[a] = static_cast<std::int64_t>(image.size[a]);
    tissues.first[a] = static_cast<std::int64_t>(all.box.lo[a]) - TissueImage::kBorder;
    tissues.size[a] = static_cast<int>(all.box.hi[a] - all.box.lo[a] + 1) + 2 * TissueImage::kBorder;
    total *= static_cast<std::size_t>(tissues.size[a]);
  }
  tissues.voxels.assign(total, 0);
  const std::size_t width = all.box.hi[0] - all.box.lo[0] + 1;
  parallel_for(
      all.box.hi[2] - all.box.lo[2] + 1,
      [&](std::size_t dk) {
        for (std::size_t j = all.box.lo[1]; j <= all.box.hi[1]; ++j) {
          const Label* from = &image.voxels[all.box.lo[0] + image.size[0] * (j + image.size[1] * (all.box.lo[2] + dk))];
          const int row = static_cast<int>(j - all.box.lo[1]) + TissueImage::kBorder;
          TissueId* to =
              &tissues.voxels[tissues.offset(TissueImage::kBorder, row, static_cast<int>(dk) + TissueImage::kBorder)];
          copy_row(from, to, width, number);
        }
      },
      1);
  std::uint64_t labelled = 0;
  for (const std::uint64_t count : tissues.counts) labelled += count;
  tissues.counts[0] = total - labelled;
  return tissues;
}

TissueImage part_of(const TissueImage& image, const std::array<std::int64_t, 3>& first,
                    const std::array<int, 3>& size) {
  TissueImage part;
  part.size = size;
  part.first = first;
  part.whole = image.whole;
  part.spacing_mm = image.spacing_mm;
  part.labels = image.labels;
  part.counts = image.counts;
  part.voxels.reserve(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                      static_cast<std::size_t>(size[2]));
  std::array<int, 3> shift;
  for (std::size_t a = 0; a < 3; ++a) shift[a] = static_cast<int>(first[a] - image.first[a]);
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i)
        part.voxels.push_back(image.at_or_background(i + shift[0], j + shift[1], k + shift[2]));
    }
  }
  return part;
}

}  // namespace anatomesh
