// The mesh as the assessment works on it: without background, its tetrahedra grouped by tissue.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "anatomesh/label_image.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh::assess_detail {

/// Position of a tissue in TissueMesh::labels. Labels may be any 32-bit values; these are dense.
using Tissue = std::uint32_t;

/// What is looked at: a tissue, parted from the others and the outside, or all of them as one body.
enum class Scope { tissue, whole };

struct TissueMesh {
  std::span<const Vec3> points_mm;               ///< those of the mesh that was given
  std::vector<std::array<VertexId, 4>> tets;     ///< of labels other than 0, in the order of the mesh
  std::vector<Tissue> tissue_of;                 ///< one a tetrahedron
  std::vector<Label> labels;                     ///< ascending; of the mesh and of the image, without 0
  std::vector<TetId> by_tissue;                  ///< all tetrahedra, those of tissue 0 first, then of tissue 1, ...
  std::vector<std::size_t> first;                ///< of each tissue in by_tissue, and the end
  std::vector<std::array<VertexId, 4>> dropped;  ///< tetrahedra of label 0
  bool negative_orientation = false;             ///< the mesh's; tets above are turned round then

  std::size_t tissue_count() const { return labels.size(); }
  std::span<const TetId> tets_of(Tissue t) const {
    return std::span<const TetId>(by_tissue).subspan(first[t], first[t + 1] - first[t]);
  }
};

/// Throws InvalidInput when points, corners and labels of the mesh do not fit together or a point is not finite.
void check_mesh(const TetMesh& mesh);

/// Of a mesh that check_mesh() finds no fault with, or it throws what that does. image_labels: ascending.
/// The points are not copied: the mesh must outlive the result.
TissueMesh make_tissue_mesh(const TetMesh& mesh, const std::vector<Label>& image_labels);

/// Position of `label` in `labels` (ascending, must hold it). Remembers the last answer, since voxels come in runs.
class LabelLookup {
 public:
  explicit LabelLookup(std::span<const Label> labels) : labels_(labels) {}
  Tissue operator()(Label label);

 private:
  std::span<const Label> labels_;
  Label last_label_ = 0;
  Tissue last_ = 0;
};

/// The labels of the image other than 0, ascending. Cost: one pass over the voxels.
std::vector<Label> labels_of(const LabelImage& image);

/// Points in continuous voxel indices of the image: voxel centres are at whole numbers.
std::vector<Vec3> to_index_space(std::span<const Vec3> points_mm, const LabelImage& image, Frame frame);

}  // namespace anatomesh::assess_detail
