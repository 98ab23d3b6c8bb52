#include "assess/tissue_mesh.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "base/rotation.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {

void check_mesh(const TetMesh& mesh) {
  if (mesh.labels.size() != mesh.tets.size()) {
    throw InvalidInput("the mesh has " + std::to_string(mesh.tets.size()) + " tetrahedra but " +
                       std::to_string(mesh.labels.size()) + " labels; there must be one each");
  }
  for (const auto& tet : mesh.tets) {
    for (const VertexId v : tet) {
      if (v >= mesh.points_mm.size()) {
        throw InvalidInput("a tetrahedron has vertex " + std::to_string(v) + " but the mesh has only " +
                           std::to_string(mesh.points_mm.size()) + " points");
      }
    }
  }
  for (const Vec3& p : mesh.points_mm) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw InvalidInput("the mesh has a point whose coordinates are not finite numbers");
    }
  }
}

namespace {

std::vector<Label> union_of(std::vector<Label> labels, const std::vector<Label>& others) {
  labels.insert(labels.end(), others.begin(), others.end());
  sort_and_unify(labels);
  if (!labels.empty() && labels.front() == 0) labels.erase(labels.begin());
  return labels;
}

void group_by_tissue(TissueMesh& mesh) {
  mesh.first.assign(mesh.labels.size() + 1, 0);
  for (const Tissue t : mesh.tissue_of) ++mesh.first[t + 1];
  for (std::size_t t = 0; t < mesh.labels.size(); ++t) mesh.first[t + 1] += mesh.first[t];
  std::vector<std::size_t> next(mesh.first.begin(), mesh.first.end() - 1);
  mesh.by_tissue.resize(mesh.tets.size());
  for (TetId i = 0; i < mesh.tets.size(); ++i) mesh.by_tissue[next[mesh.tissue_of[i]]++] = i;
}

bool mostly_negative(const TissueMesh& mesh) {
  const double positive = parallel_sum(mesh.tets.size(), 8192, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto& t = mesh.tets[i];
      const Vec3 a = mesh.points_mm[t[0]];
      count += dot(cross(mesh.points_mm[t[1]] - a, mesh.points_mm[t[2]] - a), mesh.points_mm[t[3]] - a) > 0;
    }
    return static_cast<double>(count);
  });
  return 2 * positive < static_cast<double>(mesh.tets.size());
}

}  // namespace

Tissue LabelLookup::operator()(Label label) {
  if (label != last_label_ || label == 0) {
    last_label_ = label;
    last_ = static_cast<Tissue>(std::lower_bound(labels_.begin(), labels_.end(), label) - labels_.begin());
  }
  return last_;
}

std::vector<Label> labels_of(const LabelImage& image) {
  constexpr std::size_t kGrain = std::size_t{1} << 20;
  const auto& voxels = image.voxels;
  std::vector<std::vector<Label>> found((voxels.size() + kGrain - 1) / kGrain);
  parallel_blocks(voxels.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    auto& labels = found[begin / kGrain];
    Label last = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (voxels[i] == last) continue;
      last = voxels[i];
      const auto at = std::lower_bound(labels.begin(), labels.end(), last);
      if (at == labels.end() || *at != last) labels.insert(at, last);
    }
  });
  std::vector<Label> all;
  for (const auto& labels : found) all = union_of(std::move(all), labels);
  return all;
}

TissueMesh make_tissue_mesh(const TetMesh& mesh, const std::vector<Label>& image_labels) {
  check_mesh(mesh);
  TissueMesh out;
  out.points_mm = mesh.points_mm;
  out.labels = union_of(mesh.labels, image_labels);
  out.tets.reserve(mesh.tets.size());
  out.tissue_of.reserve(mesh.tets.size());
  LabelLookup tissue(out.labels);
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    if (mesh.labels[i] == 0) {
      out.dropped.push_back(mesh.tets[i]);
    } else {
      out.tets.push_back(mesh.tets[i]);
      out.tissue_of.push_back(tissue(mesh.labels[i]));
    }
  }
  group_by_tissue(out);
  out.negative_orientation = mostly_negative(out);
  if (out.negative_orientation) {
    for (auto& t : out.tets) std::swap(t[0], t[1]);
  }
  return out;
}

std::vector<Vec3> to_index_space(std::span<const Vec3> points_mm, const LabelImage& image, Frame frame) {
  // Where the mesher lays an image whose direction is rounded.
  const bool is_rotation = deviation_from_orthonormal(image.direction) <= kDirectionTolerance;
  const Mat3 d = is_rotation ? nearest_orthonormal(image.direction) : image.direction;
  const auto column = [&](std::size_t c) { return Vec3{d[0][c], d[1][c], d[2][c]}; };
  const double scale = 1 / determinant(d);
  const std::array<Vec3, 3> inverse = {scale * cross(column(1), column(2)), scale * cross(column(2), column(0)),
                                       scale * cross(column(0), column(1))};
  const double flip = frame == Frame::ras ? -1 : 1;
  std::vector<Vec3> out(points_mm.size());
  parallel_for(points_mm.size(), [&](std::size_t i) {
    const Vec3 lps = {flip * points_mm[i].x, flip * points_mm[i].y, points_mm[i].z};
    for (std::size_t a = 0; a < 3; ++a) out[i][a] = dot(inverse[a], lps - image.origin_mm) / image.spacing_mm[a];
  });
  return out;
}

}  // namespace anatomesh::assess_detail
