// Re-meshing where the image has changed, and there only.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "anatomesh/options.h"
#include "base/stage.h"
#include "image/tissue_image.h"
#include "lattice/label_lattice.h"
#include "mesh/tissue_mesh.h"
#include "pipeline/mesh_patch.h"

namespace anatomesh {

/// A finished mesh with its background, and what is known of it, by tissue.
struct KeptMesh {
  TissueMesh mesh;
  std::vector<Fidelity> fidelity;
  std::vector<Fidelity> inside;    ///< the same of the centres inside the original image alone
  std::vector<double> volume_mm3;  ///< of its tetrahedra
  std::vector<double> surface_mm;  ///< mean length of the edges along its surface, as the whole was meshed last
  std::vector<double> area_mm2;    ///< of its boundary in the image: see boundary_areas_mm2()
  std::vector<int> pieces_off;     ///< by how many its pieces may be off the components in the image: as the whole was
  IndexBox box;                    ///< that the mesh fills at least
  std::size_t unused_vertices = 0;
};

/// Fills in all but the mesh and its fidelity. Cost: some passes over the mesh and its image.
void measure_kept(KeptMesh& kept, const TissueImage& image);

/// Where two images of the same grid and numbering of tissues differ.
struct ImageChange {
  const TissueImage& before;
  const TissueImage& after;
  std::vector<std::uint8_t> weights;                ///< of the second one's surface field
  std::vector<std::array<std::int64_t, 3>> voxels;  ///< indices in the original image, ascending
  IndexBox box;                                     ///< around them
};

struct LocalResult {
  std::string failure;       ///< why the mesh could not be mended locally; empty: it was, and `kept` is up to date
  std::size_t new_tets = 0;  ///< tetrahedra in the place of the old ones there, without the background
};

/// Brings the mesh up to date with the image. wanted: F by tissue. Leaves `kept` as it was where it fails. Throws
/// Cancelled, which leaves it so, too.
LocalResult update_locally(KeptMesh& kept, const ImageChange& change, const Options& options,
                           std::vector<double> wanted, const Stage& stage);

}  // namespace anatomesh
