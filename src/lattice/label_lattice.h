// The labelled lattice: a BCC lattice over the image, refined until each tissue reaches its fidelity, after
// Drakopoulos and Chrisochoides, "Tetrahedral Image-To-Mesh Conversion for Anatomical Modeling and Surgical
// Simulations", section on lattice refinement.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "base/stage.h"
#include "image/size_field.h"
#include "image/tissue_image.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// What the lattice is asked for; sizes are in millimetres.
struct LatticePlan {
  double bcc_size_mm = 8;        ///< spacing of the coarsest lattice
  int levels = 2;                ///< red refinements that fidelity may ask for: smallest spacing bcc_size / 2^levels
  int extra_levels = 3;          ///< further ones for a tissue that would have no tetrahedron at all
  std::vector<double> fidelity;  ///< F by tissue, [0] unused
  /// Level that is had everywhere along a tissue's boundary, whatever its fidelity; by tissue, empty: 0.
  std::vector<int> surface_level;
  const SizeField* sizes =
      nullptr;  ///< tetrahedra with longer edges are refined; null: none are. Must outlive the plan
  std::size_t most_tets = std::numeric_limits<std::size_t>::max();  ///< of the lattice with its background
  bool allow_non_manifold = false;  ///< leaves the tissues' surfaces as the labels make them
  bool keeps_background = false;    ///< background() will be asked for
};

/// Fidelity of one tissue (section "fidelity" of the paper): S1 is the set of voxels in its tetrahedra, S2 the set of
/// its voxels.
struct Fidelity {
  std::uint64_t in_tets = 0;  ///< |S1|
  std::uint64_t hits = 0;     ///< |S1 and S2|
  std::uint64_t voxels = 0;   ///< |S2|
  double f1() const { return in_tets ? static_cast<double>(hits) / static_cast<double>(in_tets) : 0; }
  double f2() const { return voxels ? static_cast<double>(hits) / static_cast<double>(voxels) : 0; }
};

struct LabelledLattice {
  TissueMesh mesh;                 ///< with its cushion of background
  std::vector<Fidelity> fidelity;  ///< by tissue, [0] unused
};

/// Where the final mesh is wrong, and how much of it must be mended.
struct FidelityGap {
  std::vector<TissueId> wrong;         ///< by voxel: the tissue that its wrong label costs fidelity, 0 where right
  std::vector<std::uint64_t> to_mend;  ///< by tissue: how many of its wrong voxels have to become right
  std::vector<std::uint32_t> missed;   ///< voxels whose label the lattice itself is to have, offsets in the image
  double missed_size_mm = 0;           ///< spacing that is fine enough for them
};

/// The lattice over one image, from its first refinement to the last. Every voxel centre of the image belongs to
/// exactly one tetrahedron (of the whole lattice, background included). A tetrahedron takes the label that most of its
/// voxels have; one with fewer than ten voxels takes it from the image interpolated at a few points inside (the
/// paper's local up-sampling, here for all tetrahedra whose vote would be noise, not only for empty ones).
///
/// Holds references to the image and the plan, which must outlive it.
class LabelLattice {
 public:
  /// Throws InvalidInput (lattice too large for its coordinates).
  LabelLattice(const TissueImage& image, const LatticePlan& plan);
  ~LabelLattice();
  LabelLattice(const LabelLattice&) = delete;
  LabelLattice& operator=(const LabelLattice&) = delete;

  /// Refines until each tissue has the plan's fidelity on the lattice, or the smallest size is reached. Throws
  /// InvalidInput (more tetrahedra than the plan has room for), Cancelled.
  LabelledLattice build(const Stage& stage);

  /// Refines the tetrahedra that hold the most wrong voxels, as many as it takes to hold those that have to be mended,
  /// and those around missed voxels until they have their label, and labels the lattice again. Nothing when all of them
  /// are of the smallest size, or when there would be more tetrahedra than the plan has room for. Throws Cancelled.
  std::optional<LabelledLattice> refine(const FidelityGap& gap, const Stage& stage);

  /// The background beyond the cushion of the lattice as it is now: together with the cushion it fills the lattice's
  /// outline. Where the two meet, vertices have the same coordinates. Cost: linear in the leaves.
  TissueMesh background() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace anatomesh
