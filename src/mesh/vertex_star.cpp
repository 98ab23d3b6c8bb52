#include "mesh/vertex_star.h"

#include <algorithm>
#include <numeric>

namespace anatomesh {

void VertexStar::gather(VertexId centre) {
  if (local_.size() < mesh_.vertex_count()) local_.resize(mesh_.vertex_count());
  vertices_.clear();
  points_.clear();
  tets_.clear();
  const auto number = [&](VertexId v) {
    const Local known = local(v);
    if (known != kNone) return known;
    local_[v] = static_cast<Local>(vertices_.size());
    vertices_.push_back(v);
    points_.push_back(mesh_.point(v));
    return local_[v];
  };
  number(centre);
  for (const TetId t : mesh_.tets_at(centre)) {
    Tet& tet = tets_.emplace_back();
    for (std::size_t n = 0; n < 4; ++n) tet.corners[n] = number(mesh_.tet(t)[n]);
    tet.tissue = mesh_.tissue(t);
  }
}

const std::vector<VertexStar::Face>& VertexStar::gather_faces() {
  sides_.clear();
  for (std::size_t t = 0; t < tets_.size(); ++t) {
    std::array<Local, 3> others;
    std::ranges::copy_if(tets_[t].corners, others.begin(), [](Local v) { return v != 0; });
    std::ranges::sort(others);
    const auto [x, y, z] = others;
    const auto n = static_cast<std::uint16_t>(t);
    sides_.insert(sides_.end(), {{x, y, n}, {x, z, n}, {y, z, n}});
  }
  std::ranges::sort(sides_);
  faces_.clear();
  for (std::size_t s = 0; s + 1 < sides_.size(); s += 2)
    faces_.push_back({sides_[s][0], sides_[s][1], sides_[s][2], sides_[s + 1][2]});
  return faces_;
}

bool VertexStar::each_tissue_is_one_piece(int count) const {
  std::vector<std::uint16_t> piece(tets_.size());
  std::iota(piece.begin(), piece.end(), std::uint16_t{0});
  const auto root = [&](std::uint16_t t) {
    while (piece[t] != t) t = piece[t] = piece[piece[t]];
    return t;
  };
  auto pieces = static_cast<int>(tets_.size());
  for (const Face& face : faces_) {
    if (tets_[face.tet0].tissue != tets_[face.tet1].tissue) continue;
    const std::uint16_t a = root(face.tet0), b = root(face.tet1);
    if (a == b) continue;
    piece[a] = b;
    --pieces;
  }
  return pieces == count;
}

}  // namespace anatomesh
