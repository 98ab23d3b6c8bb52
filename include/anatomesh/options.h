// Every option of the mesher. The command line, Python, Slicer and SOFA carry the same names.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "anatomesh/types.h"

namespace anatomesh {

/// How the boundary's edge points are thinned: no two chosen ones may touch at a vertex, edge or face
/// of their voxels (26, 18, 6 neighbours); none keeps all (Drakopoulos and Chrisochoides, Table 2).
enum class NonConnectivity { vertex, edge, face, none };

/// Linear-elastic material of a tissue in the registration. Only ratios of moduli matter to the mesh.
struct Material {
  double young_modulus_pa = 3000;  ///< > 0
  double poisson_ratio = 0.45;     ///< >= 0, < 0.5
};

/// Where a tissue's fidelity is judged: on the undeformed lattice, as in the paper, or on the final mesh, which mostly
/// takes fewer elements for the same F.
enum class FidelityStage { lattice, final };

/// Stage "lattice": the body-centred cubic lattice and its refinement.
struct LatticeOptions {
  /// Spacing of the coarsest lattice, > 0; 0: the one from 8 to 16 times the mean voxel spacing that suits the
  /// surfaces best, 8 times for a fidelity on the lattice.
  double bcc_size_mm = 0;
  /// Smallest lattice spacing that fidelity may ask for, > 0; 0: an eighth of bcc_size, half the mean voxel spacing
  /// where bcc_size is 0, too, and a quarter of bcc_size for a fidelity on the lattice. There a tissue that is still
  /// 0.15 short of its fidelity gets half of it.
  double min_size_mm = 0;
  double fidelity = 0.95;                  ///< 0 < F <= 1: F1 and F2 that each tissue is refined for
  std::map<Label, double> fidelity_label;  ///< F of single tissues, in place of the above
  FidelityStage fidelity_stage = FidelityStage::final;
  /// Most tetrahedra of the final mesh; 0: as many as the fidelity takes. The best fidelity that they allow, F at most;
  /// needs fidelity_stage final.
  std::uint64_t max_elements = 0;
  std::map<Label, double> size_label;  ///< longest edge inside a tissue where the bounds allow, mm, > 0
  /// Tetrahedra across a tissue where it is thin, 0 to 16: edges at most its local thickness over this; 0: not asked.
  int elements_across = 0;
  /// Components (26-connected) of fewer voxels than this take the label around them; 0: none. They are named in the
  /// result's warnings.
  std::uint64_t drop_islands = 0;
  /// Leaves the surfaces of tissues as the labels of the lattice make them, with edges of more than two faces.
  bool allow_non_manifold = false;
};

/// Stage "deform": registration onto the boundary, angle guard, settling, improvement.
struct DeformOptions {
  NonConnectivity non_connectivity = NonConnectivity::face;
  int iterations = 10;            ///< 0 to 1000, of the registration at most; 0 keeps the lattice
  double min_dihedral_deg = 20;   ///< 0 to 30
  double max_dihedral_deg = 150;  ///< 117 to 180
  double min_mean_ratio = 0.3;    ///< 0 to 0.5; 12 (3 V)^(2/3) / sum of squared edges, 1: regular
  double gradation = 0;           ///< mm that edges may be longer a mm farther from the interfaces, >= 0; 0: no limit
  std::map<Label, Material> material;  ///< of single tissues; the rest takes default_material
  Material default_material;
};

/// All options of image_to_mesh().
struct Options {
  LatticeOptions lattice;
  DeformOptions deform;
  std::vector<Label> labels;  ///< mesh these only, the rest is background; empty: all
  Frame frame = Frame::lps;   ///< space of the resulting mesh
  int order = 1;              ///< 1: linear tetrahedra, 2: quadratic ones, by quadratic_mesh() within the bounds
  int threads = 0;            ///< >= 0; 0: all cores. The result does not depend on it
  double max_memory_gib = 0;  ///< refuse a mesh that takes more by estimate; >= 0; 0: the memory this machine has free
};

}  // namespace anatomesh
