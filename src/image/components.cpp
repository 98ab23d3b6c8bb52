#include "image/components.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace anatomesh {
namespace {

/// Calls visit(begin, end) for the runs of equal tissue in a row, those of the background left out.
template <class Visit>
void for_each_run(const TissueImage& image, std::size_t row, const Visit& visit) {
  const auto nx = static_cast<std::size_t>(image.size[0]);
  const TissueId* voxels = &image.voxels[row * nx];
  for (std::size_t begin = 0, end = 0; begin < nx; begin = end) {
    while (end < nx && voxels[end] == voxels[begin]) ++end;
    if (voxels[begin] != 0)
      visit(static_cast<std::uint32_t>(row * nx + begin), static_cast<std::uint32_t>(row * nx + end));
  }
}

}  // namespace

ImageComponents::ImageComponents(const TissueImage& image) : row_length_(static_cast<std::uint32_t>(image.size[0])) {
  find_runs(image);
  join_and_number(image);
}

void ImageComponents::find_runs(const TissueImage& image) {
  const std::size_t rows = image.voxels.size() / row_length_;
  first_run_.assign(rows + 1, 0);
  parallel_for(
      rows, [&](std::size_t row) { for_each_run(image, row, [&](auto, auto) { ++first_run_[row + 1]; }); }, 256);
  std::partial_sum(first_run_.begin(), first_run_.end(), first_run_.begin());
  runs_.resize(first_run_.back());
  parallel_for(
      rows,
      [&](std::size_t row) {
        std::uint32_t next = first_run_[row];
        for_each_run(image, row, [&](auto begin, auto end) { runs_[next++] = {begin, end, 0}; });
      },
      256);
}

void ImageComponents::join_and_number(const TissueImage& image) {
  DisjointSets sets(runs_.size());
  const int ny = image.size[1], nz = image.size[2];
  const auto join_rows = [&](std::size_t row, std::size_t other) {
    const auto shift = static_cast<std::uint32_t>((row - other) * row_length_);
    std::uint32_t b = first_run_[other];
    for (std::uint32_t a = first_run_[row]; a < first_run_[row + 1]; ++a) {
      const std::uint32_t begin = runs_[a].begin - shift, end = runs_[a].end - shift;
      while (b < first_run_[other + 1] && runs_[b].end < begin) ++b;
      for (std::uint32_t c = b; c < first_run_[other + 1] && runs_[c].begin <= end; ++c) {
        if (image.voxels[runs_[c].begin] == image.voxels[runs_[a].begin]) sets.join(a, c);
      }
    }
  };
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      const auto row = static_cast<std::size_t>(j + ny * static_cast<std::int64_t>(k));
      const auto layer = static_cast<std::size_t>(ny);
      if (j > 0) join_rows(row, row - 1);
      if (k == 0) continue;
      join_rows(row, row - layer);
      if (j > 0) join_rows(row, row - layer - 1);
      if (j + 1 < ny) join_rows(row, row - layer + 1);
    }
  }
  for (std::uint32_t r = 0; r < runs_.size(); ++r) {
    Run& run = runs_[r];
    if (sets.is_root(r)) {  // the first run of its component
      run.component = static_cast<std::uint32_t>(list_.size());
      list_.push_back({image.voxels[run.begin], 0, run.begin});
    } else {
      run.component = runs_[sets.root(r)].component;
    }
    list_[run.component].voxels += run.end - run.begin;
  }
}

std::uint32_t ImageComponents::of(std::uint32_t voxel) const {
  const std::uint32_t row = voxel / row_length_;
  const auto begin = runs_.begin() + first_run_[row], end = runs_.begin() + first_run_[row + 1];
  const auto after = std::upper_bound(begin, end, voxel, [](std::uint32_t v, const Run& run) { return v < run.begin; });
  return std::prev(after)->component;
}

std::vector<std::uint32_t> ImageComponents::count_by_tissue(std::size_t tissues) const {
  std::vector<std::uint32_t> counts(tissues, 0);
  for (const ImageComponent& component : list_) ++counts[component.tissue];
  return counts;
}

namespace {

// Numbers of the components to drop, the smallest first.
std::vector<std::uint32_t> find_islands(const std::vector<ImageComponent>& list, std::size_t tissues,
                                        std::uint64_t min_voxels) {
  constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> largest(tissues, kNone), islands;
  for (std::uint32_t c = 0; c < list.size(); ++c) {
    std::uint32_t& best = largest[list[c].tissue];
    if (best == kNone || list[c].voxels > list[best].voxels) best = c;
  }
  for (std::uint32_t c = 0; c < list.size(); ++c) {
    if (list[c].voxels < min_voxels && largest[list[c].tissue] != c) islands.push_back(c);
  }
  std::stable_sort(islands.begin(), islands.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return list[a].voxels < list[b].voxels; });
  return islands;
}

// Tissue behind most of the faces of these voxels that lead to another tissue; of equal ones the lowest.
TissueId surrounding_tissue(const TissueImage& image, const std::vector<std::uint32_t>& voxels) {
  const TissueId own = image.voxels[voxels.front()];
  const auto nx = static_cast<std::uint32_t>(image.size[0]), ny = static_cast<std::uint32_t>(image.size[1]);
  std::map<TissueId, std::uint64_t> faces;
  for (const std::uint32_t v : voxels) {
    const int i = static_cast<int>(v % nx), j = static_cast<int>(v / nx % ny), k = static_cast<int>(v / nx / ny);
    for (const int step : {-1, 1}) {
      ++faces[image.at_or_background(i + step, j, k)];
      ++faces[image.at_or_background(i, j + step, k)];
      ++faces[image.at_or_background(i, j, k + step)];
    }
  }
  faces.erase(own);
  if (faces.empty()) return own;  // all around it have been given its tissue
  return std::max_element(faces.begin(), faces.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
}

}  // namespace

std::vector<DroppedIsland> drop_islands(TissueImage& image, std::uint64_t min_voxels) {
  const ImageComponents components(image);
  const auto islands = find_islands(components.list(), image.labels.size(), min_voxels);
  std::vector<std::uint32_t> place(components.list().size(), static_cast<std::uint32_t>(islands.size()));
  for (std::uint32_t n = 0; n < islands.size(); ++n) place[islands[n]] = n;
  std::vector<std::vector<std::uint32_t>> voxels(islands.size());
  for (const auto& run : components.runs()) {
    if (place[run.component] == islands.size()) continue;
    for (std::uint32_t v = run.begin; v < run.end; ++v) voxels[place[run.component]].push_back(v);
  }
  std::vector<DroppedIsland> dropped;
  for (const auto& island : voxels) {
    const TissueId own = image.voxels[island.front()], other = surrounding_tissue(image, island);
    for (const std::uint32_t v : island) image.voxels[v] = other;
    image.counts[own] -= island.size();
    image.counts[other] += island.size();
    dropped.push_back({own, island.size()});
  }
  return dropped;
}

}  // namespace anatomesh
