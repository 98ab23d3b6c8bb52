#include "lattice/voxel_votes.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "base/vec.h"
#include "lattice/root_voxels.h"

namespace anatomesh {
namespace {

// Counts by tissue; few tissues meet in one tetrahedron, so a list does.
class Ballot {
 public:
  void add(TissueId tissue, double weight) {
    if (last_ < entries_.size() && entries_[last_].first == tissue) {
      entries_[last_].second += weight;
      return;
    }
    for (last_ = 0; last_ < entries_.size(); ++last_) {
      if (entries_[last_].first == tissue) {
        entries_[last_].second += weight;
        return;
      }
    }
    entries_.emplace_back(tissue, weight);
  }
  // Most votes; of equal ones the lowest tissue, so that the order of voting does not matter.
  std::pair<TissueId, double> winner() const {
    std::pair<TissueId, double> best = {0, 0};
    for (const auto& e : entries_) {
      if (e.second > best.second || (e.second == best.second && e.first < best.first)) best = e;
    }
    return best;
  }
  void clear() {
    entries_.clear();
    last_ = 0;
  }

 private:
  std::vector<std::pair<TissueId, double>> entries_;
  std::size_t last_ = 0;
};

Ballot& thread_ballot() {
  thread_local Ballot ballot;
  ballot.clear();
  return ballot;
}

std::uint64_t new_state() {
  static std::atomic<std::uint64_t> states = 0;
  return ++states;
}

// What an index may be at the most; no image is so large.
constexpr double kFarthest = 1 << 30;

// As std::floor and std::lround do, in range and without a call.
int floor_of(double x) {
  const double near = std::clamp(x, -kFarthest, kFarthest);
  const int whole = static_cast<int>(near);
  return whole - (near < whole);
}
int nearest_to(double x) {
  const double near = std::clamp(x, -kFarthest, kFarthest);
  const int whole = static_cast<int>(near);
  const double rest = near - whole;
  return whole + (rest >= 0.5) - (rest <= -0.5);
}

Vec3 blend(const std::array<Vec3, 4>& corners, const std::array<double, 4>& weight) {
  return weight[0] * corners[0] + weight[1] * corners[1] + weight[2] * corners[2] + weight[3] * corners[3];
}

}  // namespace

VoxelVotes::VoxelVotes(const TissueImage& image, const RedGreenLattice& lattice, Vec3 origin_mm, double unit_mm)
    : image_(image),
      lattice_(lattice),
      rows_per_voxel_(1.0 / image.size[0]),
      layers_per_row_(1.0 / image.size[1]),
      begin_(static_cast<std::size_t>(lattice.max_level()) + 1),
      votes_(static_cast<std::size_t>(lattice.max_level()) + 1) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (int i = 0; i < image.size[a]; ++i)
      position_[a].push_back((static_cast<double>(image.first[a] + i) * image.spacing_mm[a] - origin_mm[a]) / unit_mm);
    index_per_unit_[a] = unit_mm / image.spacing_mm[a];
    index_of_origin_[a] = origin_mm[a] / image.spacing_mm[a] - static_cast<double>(image.first[a]);
  }
  vote_in_roots();
  state_ = new_state();
}

// Quotients are those of integers: they are at least half a part away from the next one, far beyond rounding.
Vec3 VoxelVotes::position(std::uint32_t voxel, int level) const {
  const auto nx = static_cast<std::uint32_t>(image_.size[0]), ny = static_cast<std::uint32_t>(image_.size[1]);
  const double scale = static_cast<double>(1 << level);
  const auto row = static_cast<std::uint32_t>((voxel + 0.5) * rows_per_voxel_);
  const auto layer = static_cast<std::uint32_t>((row + 0.5) * layers_per_row_);
  return {scale * position_[0][voxel - row * nx], scale * position_[1][row - layer * ny], scale * position_[2][layer]};
}

// The tissue of most voxels, and of how many.
std::pair<TissueId, std::uint32_t> VoxelVotes::most_frequent(std::span<const std::uint32_t> voxels) const {
  if (voxels.empty()) return {0, 0};
  const TissueId first = image_.voxels[voxels[0]];
  std::size_t same = 1;
  while (same < voxels.size() && image_.voxels[voxels[same]] == first) ++same;
  if (same == voxels.size()) return {first, static_cast<std::uint32_t>(same)};
  Ballot& ballot = thread_ballot();
  ballot.add(first, static_cast<double>(same));
  for (const std::uint32_t v : voxels.subspan(same)) ballot.add(image_.voxels[v], 1);
  const auto [tissue, votes] = ballot.winner();
  return {tissue, static_cast<std::uint32_t>(votes)};
}

// corners(): those of the tetrahedron; only asked for where voxels are few.
template <class Corners>
Vote VoxelVotes::count_votes(std::span<const std::uint32_t> voxels, const Corners& corners) const {
  const auto [tissue, votes] = most_frequent(voxels);
  Vote result;
  result.count = static_cast<std::uint32_t>(voxels.size());
  const bool unanimous = votes == result.count && !voxels.empty();
  result.tissue = tissue;
  result.hits = votes;
  if (result.count < kQuorum) {
    const TissueId chosen = interpolated_tissue(corners());
    if (chosen != tissue || voxels.empty()) {
      result.tissue = chosen;
      result.hits = 0;
      for (const std::uint32_t v : voxels) result.hits += image_.voxels[v] == chosen;
    }
  }
  result.pure = voxels.empty() || (unanimous && result.tissue == tissue);
  return result;
}

void VoxelVotes::vote_in_roots() {
  RootVoxels roots = sort_into_roots(position_, lattice_.root_cells());
  order_ = std::move(roots.order);
  begin_[0] = std::move(roots.begin);
  votes_[0].resize(lattice_.slot_count(0));
  parallel_for(
      votes_[0].size(),
      [&](std::size_t s) {
        const std::uint32_t first = begin_[0][s], count = begin_[0][s + 1] - first;
        votes_[0][s] = count_votes({&order_[0] + first, count}, [&] {
          return corners_in_voxels({0, static_cast<std::uint32_t>(s)});
        });
      },
      64);
}

void VoxelVotes::descend(const std::vector<TetRef>& refined) {
  state_ = new_state();
  for (std::size_t level = 1; level < votes_.size(); ++level) {
    begin_[level].resize(lattice_.slot_count(static_cast<int>(level)));
    votes_[level].resize(lattice_.slot_count(static_cast<int>(level)));
  }
  for (int level = 0; level < lattice_.max_level(); ++level) {
    std::vector<TetRef> parents;
    for (const TetRef t : refined) {
      if (t.level == level) parents.push_back(t);
    }
    parallel_for(
        parents.size(), [&](std::size_t i) { hand_down(parents[i]); }, 64);
  }
}

void VoxelVotes::hand_down(TetRef parent) {
  const auto level = static_cast<std::size_t>(parent.level);
  const Vote whole = votes_[level][parent.slot];
  const auto children = lattice_.children(parent);
  if (hands_label_down(parent)) {
    for (const TetRef child : children) {
      begin_[level + 1][child.slot] = kInherited;
      votes_[level + 1][child.slot] = {0, 0, whole.tissue, true};
    }
    return;
  }
  const LatticePoint b = lattice_.barycentre(parent);
  std::uint32_t* const first = &order_[0] + begin_[level][parent.slot];
  const BccFrame frame(b);
  thread_local std::array<std::vector<std::uint32_t>, 8> parts;
  for (auto& part : parts) part.clear();
  for (std::uint32_t v = 0; v < whole.count; ++v)
    parts[static_cast<std::size_t>(bcc_child_at(b, frame, position(first[v], parent.level)))].push_back(first[v]);
  std::uint32_t next = begin_[level][parent.slot];
  for (std::size_t c = 0; c < 8; ++c) {
    std::copy(parts[c].begin(), parts[c].end(), &order_[0] + next);
    begin_[level + 1][children[c].slot] = next;
    votes_[level + 1][children[c].slot] =
        count_votes({&order_[0] + next, parts[c].size()}, [&] { return corners_in_voxels(children[c]); });
    next += static_cast<std::uint32_t>(parts[c].size());
  }
}

std::vector<TetRef> VoxelVotes::keep_voxels(TetRef t) {
  state_ = new_state();
  std::vector<TetRef> renewed;
  const auto level = static_cast<std::size_t>(t.level);
  if (is_inherited(t)) {
    TetRef parent;
    lattice_.find(t.level - 1, bcc_parent(lattice_.barycentre(t)), parent);
    renewed = keep_voxels(parent);
    hand_down_again(parent, renewed);
  }
  votes_[level][t.slot].pure = false;
  return renewed;
}

// To all below it that do not hand a label down.
void VoxelVotes::hand_down_again(TetRef parent, std::vector<TetRef>& renewed) {
  hand_down(parent);
  for (const TetRef child : lattice_.children(parent)) {
    renewed.push_back(child);
    if (lattice_.is_refined(child) && !hands_label_down(child)) hand_down_again(child, renewed);
  }
}

std::span<const std::uint32_t> VoxelVotes::voxels(TetRef t) const {
  const auto level = static_cast<std::size_t>(t.level);
  const Vote& v = votes_[level][t.slot];
  return v.count ? std::span<const std::uint32_t>(&order_[0] + begin_[level][t.slot], v.count)
                 : std::span<const std::uint32_t>();
}

std::optional<VoxelVotes::Holder> VoxelVotes::holder_of(std::uint32_t voxel) const {
  TetRef t;
  if (!lattice_.find(0, bcc_locate(position(voxel, 0)), t)) return {};
  while (lattice_.is_refined(t)) {
    const LatticePoint b = lattice_.barycentre(t);
    const auto child = static_cast<std::size_t>(bcc_child_at(b, position(voxel, t.level)));
    lattice_.find(t.level + 1, bcc_children(b)[child], t);
    if (is_inherited(t)) return {};
  }
  const unsigned mask = lattice_.split_edges(t);
  if (mask == 0) return Holder{t, 0};
  return Holder{t, green_child_at(mask, bcc_barycentric_times_4(lattice_.barycentre(t), position(voxel, t.level)))};
}

// Good until the thread's next call for another leaf. The parts of one are asked for one after the other, so the last
// answer is kept.
const VoxelVotes::GreenVoxels& VoxelVotes::voxels_of_green_parts(TetRef leaf) const {
  struct Answer {
    std::uint64_t state = 0;
    TetRef leaf;
    unsigned mask = 0;
    GreenVoxels parts;
  };
  thread_local Answer last;
  const LatticePoint b = lattice_.barycentre(leaf);
  const unsigned mask = lattice_.split_edges(leaf);
  GreenVoxels& parts = last.parts;
  if (last.state == state_ && last.leaf == leaf && last.mask == mask) return parts;
  last.state = state_, last.leaf = leaf, last.mask = mask;
  for (auto& part : parts) part.clear();
  for (const std::uint32_t v : voxels(leaf)) {
    const int child = green_child_at(mask, bcc_barycentric_times_4(b, position(v, leaf.level)));
    parts[static_cast<std::size_t>(child)].push_back(v);
  }
  return parts;
}

std::span<const std::uint32_t> VoxelVotes::voxels_of_part(TetRef leaf, std::size_t part) const {
  if (lattice_.split_edges(leaf) == 0) return voxels(leaf);
  return voxels_of_green_parts(leaf)[part];
}

std::uint32_t VoxelVotes::voxels_of(TetRef leaf, std::size_t part, TissueId tissue) const {
  const auto all = voxels_of_part(leaf, part);
  return static_cast<std::uint32_t>(
      std::count_if(all.begin(), all.end(), [&](std::uint32_t v) { return image_.voxels[v] == tissue; }));
}

std::array<Vote, 4> VoxelVotes::green_votes(TetRef leaf) const {
  const GreenSplit& split = green_split(lattice_.split_edges(leaf));
  const Vote& whole = vote(leaf);
  std::array<Vote, 4> votes;
  if (hands_label_down(leaf)) {
    votes.fill({0, 0, whole.tissue, true});
    votes[0].count = votes[0].hits = whole.count;  // together they hold what the leaf holds
    return votes;
  }
  const GreenVoxels& parts = voxels_of_green_parts(leaf);
  const std::array<Vec3, 4> corners = corners_in_voxels(leaf);
  for (std::size_t c = 0; c < static_cast<std::size_t>(split.count); ++c) {
    std::array<Vec3, 4> part;
    for (std::size_t n = 0; n < 4; ++n) {
      const std::size_t node = split.tets[c][n];
      part[n] = node < 4 ? corners[node]
                         : 0.5 * (corners[static_cast<std::size_t>(kTetEdges[node - 4][0])] +
                                  corners[static_cast<std::size_t>(kTetEdges[node - 4][1])]);
    }
    votes[c] = count_votes(parts[c], [&] { return part; });
  }
  return votes;
}

Vec3 VoxelVotes::to_voxel_index(LatticePoint point, int level) const {
  Vec3 index;
  const double scale = 1.0 / static_cast<double>(1 << level);
  for (std::size_t a = 0; a < 3; ++a) index[a] = index_of_origin_[a] + scale * point[a] * index_per_unit_[a];
  return index;
}

std::array<Vec3, 4> VoxelVotes::corners_in_voxels(TetRef t) const {
  std::array<Vec3, 4> corners;
  const auto vertices = bcc_vertices(lattice_.barycentre(t));
  for (std::size_t v = 0; v < 4; ++v) corners[v] = to_voxel_index(vertices[v], t.level);
  return corners;
}

std::array<TissueId, 4> VoxelVotes::tissues_at_corners(TetRef t) const {
  std::array<TissueId, 4> tissues;
  const std::array<Vec3, 4> corners = corners_in_voxels(t);
  for (std::size_t n = 0; n < 4; ++n) {
    const auto nearest = [&](std::size_t axis) { return nearest_to(corners[n][axis]); };
    tissues[n] = image_.at_or_background(nearest(0), nearest(1), nearest(2));
  }
  return tissues;
}

// The tissue of all voxels from `low` to `high`; none where they differ, or are too many to look at.
std::optional<TissueId> VoxelVotes::only_tissue(const std::array<int, 3>& low, const std::array<int, 3>& high) const {
  constexpr int kMost = 5;  // along an axis
  for (std::size_t a = 0; a < 3; ++a) {
    if (std::int64_t{high[a]} - low[a] >= kMost) return {};
  }
  const TissueId first = image_.at_or_background(low[0], low[1], low[2]);
  const bool inside = image_.contains(low[0], low[1], low[2]) && image_.contains(high[0], high[1], high[2]);
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      const TissueId* row = inside ? &image_.voxels[image_.offset(low[0], j, k)] : nullptr;
      for (int i = low[0]; i <= high[0]; ++i) {
        if ((inside ? row[i - low[0]] : image_.at_or_background(i, j, k)) != first) return {};
      }
    }
  }
  return first;
}

namespace {

// Eight voxels around a point, and where it lies between them.
struct Around {
  std::array<TissueId, 8> tissues;  // x fastest
  Vec3 share;
};

// Which of two tissues has more of all points, by fewer operations than summing up takes; none where there are more
// tissues, or where rounding might decide.
std::optional<TissueId> winner_of_two(const std::array<Around, 5>& points) {
  constexpr double kSure = 1e-9;
  const TissueId first = points[0].tissues[0];
  TissueId second = first;
  double lead = 0;  // of the first
  for (const Around& point : points) {
    std::array<double, 8> side;
    for (std::size_t c = 0; c < 8; ++c) {
      const TissueId tissue = point.tissues[c];
      if (tissue != first && second == first) second = tissue;
      if (tissue != first && tissue != second) return {};
      side[c] = tissue == first ? 1 : -1;
    }
    const auto [x, y, z] = point.share;
    for (std::size_t c = 0; c < 4; ++c) side[c] = side[2 * c] + x * (side[2 * c + 1] - side[2 * c]);
    for (std::size_t c = 0; c < 2; ++c) side[c] = side[2 * c] + y * (side[2 * c + 1] - side[2 * c]);
    lead += side[0] + z * (side[1] - side[0]);
  }
  if (std::abs(lead) < kSure) return {};
  return lead > 0 ? first : second;
}

}  // namespace

// Trilinear interpolation of the tissues' indicator functions, summed over five points inside.
TissueId VoxelVotes::interpolated_tissue(const std::array<Vec3, 4>& corners) const {
  constexpr double kIn = 0.55, kOff = 0.15;
  constexpr std::array<std::array<double, 4>, 5> kPoints = {{{0.25, 0.25, 0.25, 0.25},
                                                             {kIn, kOff, kOff, kOff},
                                                             {kOff, kIn, kOff, kOff},
                                                             {kOff, kOff, kIn, kOff},
                                                             {kOff, kOff, kOff, kIn}}};
  std::array<Vec3, 5> points;
  std::array<std::array<int, 3>, 5> lows;
  std::array<int, 3> low, high;
  for (std::size_t n = 0; n < 5; ++n) {
    points[n] = blend(corners, kPoints[n]);
    for (std::size_t a = 0; a < 3; ++a) {
      const int at = lows[n][a] = floor_of(points[n][a]);
      low[a] = n == 0 ? at : std::min(low[a], at);
      high[a] = n == 0 ? at + 1 : std::max(high[a], at + 1);
    }
  }
  if (const auto only = only_tissue(low, high)) return *only;
  const bool inside = image_.contains(low[0], low[1], low[2]) && image_.contains(high[0], high[1], high[2]);
  std::array<Around, 5> around;
  for (std::size_t n = 0; n < 5; ++n) {
    const auto [i, j, k] = lows[n];
    around[n].share = {points[n].x - i, points[n].y - j, points[n].z - k};
    for (int c = 0; c < 8; ++c) {
      const int x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
      around[n].tissues[static_cast<std::size_t>(c)] = inside ? image_.at(x, y, z) : image_.at_or_background(x, y, z);
    }
  }
  if (const auto winner = winner_of_two(around)) return *winner;
  Ballot& ballot = thread_ballot();
  for (const auto& [tissues, share] : around) {
    for (std::size_t c = 0; c < 8; ++c) {
      const double x = c & 1u ? share.x : 1 - share.x, y = c & 2u ? share.y : 1 - share.y;
      ballot.add(tissues[c], x * y * (c & 4u ? share.z : 1 - share.z));
    }
  }
  return ballot.winner().first;
}

}  // namespace anatomesh
