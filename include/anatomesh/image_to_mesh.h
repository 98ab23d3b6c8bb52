// The main door: from a segmented image to a tetrahedral mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "anatomesh/label_image.h"
#include "anatomesh/options.h"
#include "anatomesh/progress.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// What became of one tissue of the image.
struct TissueOutcome {
  Label label = 0;
  std::uint64_t voxels = 0;  ///< in the image
  std::uint64_t tets = 0;    ///< in the mesh; 0: the tissue could not be represented
  double fidelity = 0;       ///< the F asked for
  double lattice_f1 = 0;     ///< F1 reached on the undeformed lattice (0 to 1)
  double lattice_f2 = 0;     ///< F2 reached on the undeformed lattice (0 to 1)
  double f1 = 0;             ///< F1 of the final mesh (0 to 1)
  double f2 = 0;             ///< F2 of the final mesh (0 to 1)
};

/// Wall-clock time of one stage.
struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// What image_to_mesh() returns.
struct Result {
  TetMesh mesh;                        ///< in options.frame; positively oriented
  std::vector<TissueOutcome> tissues;  ///< by ascending label, every meshed label of the image
  std::vector<std::string> warnings;   ///< sentences for the user, e.g. a tissue not represented
  std::vector<StageTime> times;
  Options options;  ///< as used: sizes that were 0 are filled in
};

/// Meshes every tissue of the image (Drakopoulos and Chrisochoides, "Tetrahedral Image-To-Mesh
/// Conversion for Anatomical Modeling and Surgical Simulations", with an angle guard of our own).
/// The same image and options give the same bytes, whatever the number of threads.
/// Cost: about linear in voxels and tetrahedra; roughly 1 KB a tetrahedron beside the image.
/// Throws InvalidOption, InvalidInput (image), MeshingFailed, Cancelled.
Result image_to_mesh(const LabelImage& image, const Options& options = {}, const Progress& progress = {});

/// Throws InvalidOption unless every option is in its range. Does not look at an image.
void check_options(const Options& options);

/// Throws InvalidInput unless the image can be meshed: size, spacing, direction, at least one label.
void check_image(const LabelImage& image);

}  // namespace anatomesh
