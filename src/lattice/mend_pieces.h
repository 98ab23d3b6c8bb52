// Gives each tissue as many pieces (tetrahedra that hang together by faces) as the image has 26-connected components
// of it, by relabelling tetrahedra; where they are too large for that, says which ones to refine.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "image/components.h"
#include "lattice/mend_surfaces.h"
#include "lattice/tet_complex.h"

namespace anatomesh {

/// What the image says about the tetrahedra of a complex.
struct TetContents {
  /// Offsets of the voxels inside a tetrahedron; empty for the parts of a large pure one. Good until the thread's next
  /// call. Called in parallel.
  std::function<std::span<const std::uint32_t>(TetId)> voxels;
  /// The tetrahedron among whose voxels one is, or TetComplex::kNone.
  std::function<TetId(std::uint32_t)> holder;
  std::vector<float> sizes;      ///< volumes, in voxels
  std::vector<char> fixed;       ///< inside a large pure tetrahedron: keeps its tissue
  std::vector<char> may_refine;  ///< whether the lattice can be refined there
  std::vector<char> decided;     ///< its tissue was given by an earlier repair
  std::vector<char> held;        ///< at the border of a part of a mesh: keeps its tissue; empty: none is
};

/// The component that a tetrahedron stands for, and by how many voxels of it.
struct Claim {
  std::uint32_t component = Pieces::kNone;
  std::uint32_t voxels = 0;
  TissueId of = 0;  ///< the tissue that it was found for; background: not found yet
};

/// Offset of the voxel that a point (mm, in the image's frame) lies in; none outside the crop.
std::optional<std::uint32_t> voxel_at(const TissueImage& image, Vec3 point_mm);

/// What it costs, in voxels, to give a tetrahedron another tissue: voxels lost less those gained, at least 0; more
/// than kTooDear where it is fixed.
RelabelPrice voxel_price(const TetComplex& complex, const TissueImage& image, const TetContents& contents);

struct PieceRepair {
  std::vector<TetId> changed;  ///< relabelled
  std::vector<TetId> refine;   ///< to be refined before more can be done
};

/// Pieces without a voxel of their own go to what surrounds them; a component that no tetrahedron has taken
/// gets the one with most of its voxels; pieces of one component are joined along the cheapest path of tetrahedra; a
/// piece that holds several components is cut half way between them. One repair may call for another: a few passes.
/// claims: by tetrahedron; those found before are relied on, others are added where they are needed.
PieceRepair mend_pieces(TetComplex& complex, Pieces& pieces, const TissueImage& image,
                        const ImageComponents& components, const TetContents& contents, std::vector<Claim>& claims);

}  // namespace anatomesh
