// A part of a mesh that is changed while the rest stays as it is.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "image/tissue_image.h"
#include "lattice/tet_complex.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Voxels low to high (excluded) of the original image along each axis; may go beyond it.
struct IndexBox {
  std::array<std::int64_t, 3> low = {0, 0, 0}, high = {0, 0, 0};
  bool empty() const { return high[0] <= low[0]; }
};

/// All voxels of a crop.
IndexBox box_of(const TissueImage& image);

/// A set of voxels, kept as cubes of a few voxels that hold one.
class VoxelBlocks {
 public:
  static constexpr std::int64_t kSide = 2;

  explicit VoxelBlocks(const IndexBox& box);
  void add(const std::array<std::int64_t, 3>& voxel);
  /// Adds what is within so many blocks along each axis.
  void dilate(int blocks);
  /// Whether a box (mm, in the image's frame) meets one of them.
  bool meets(Vec3 low_mm, Vec3 high_mm, Vec3 spacing_mm) const;

 private:
  std::array<std::int64_t, 3> low_, size_;
  std::vector<char> marked_;
  std::size_t place(std::int64_t i, std::int64_t j, std::int64_t k) const;
};

/// What hangs together in the rest of the mesh, for some of the tissues.
struct RestPieces {
  /// Vertex of the patch, tissue, number of the piece of the rest that has it.
  struct Contact {
    VertexId vertex;
    TissueId tissue;
    std::uint32_t piece;
  };
  std::vector<Contact> contacts;
  std::vector<char> counted;          ///< by tissue: whether it is one of those
  std::vector<std::uint32_t> closed;  ///< by tissue: pieces of the rest that do not touch the patch
};

struct MeshPatch {
  TissueMesh mesh;                 ///< with vertices of its own
  std::vector<TetId> tets;         ///< the same in the whole mesh
  std::vector<VertexId> vertices;  ///< by vertex: the same in the whole mesh
  std::vector<char> is_border;     ///< by vertex: on a face to the rest, or of one tetrahedron only
};

/// The tetrahedra that meet the blocks, and `rings` rings of those that touch them. Cost: some passes over the mesh.
MeshPatch take_patch(const TissueMesh& whole, const VoxelBlocks& blocks, Vec3 spacing_mm, int rings);

/// Puts `changed` in the place of the patch. It fills the same space, with the same border; vertices of the border are
/// known by their coordinates. Vertices and tetrahedra take the numbers of those that go; vertices of no tetrahedron
/// may remain: returns how many do. Cost: linear in the patch.
std::size_t put_patch(TissueMesh& whole, const MeshPatch& patch, const TissueMesh& changed);

/// By vertex: whether it lies on a face of one tetrahedron only.
std::vector<char> border_vertices(const TetComplex& complex);
std::vector<char> border_vertices(const TissueMesh& mesh);

/// In a mesh whose tissues' surfaces are manifold. counted: by tissue, whether to look at it; [0] unused. Cost: a pass
/// over the mesh for each of them.
RestPieces find_rest_pieces(const TissueMesh& whole, const MeshPatch& patch, std::vector<char> counted);

}  // namespace anatomesh
