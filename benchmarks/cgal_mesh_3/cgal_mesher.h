// CGAL's Mesh_3 as a peer: the same image in, the same kind of mesh out.
#pragma once

#include "anatomesh/label_image.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh::peers {

/// Criteria of CGAL's mesher, named and defaulted as in its examples of segmented images.
struct CgalOptions {
  double facet_angle_deg = 30;        ///< smallest angle of a surface face
  double facet_size_mm = 3;           ///< largest radius of the surface Delaunay ball of a face
  double facet_distance_mm = 0.5;     ///< largest distance of a face's centre from that of its ball
  double cell_radius_edge_ratio = 3;  ///< largest circumradius over shortest edge of a tetrahedron
  double cell_size_mm = 4;            ///< largest circumradius of a tetrahedron
  double weights_sigma_mm = 0;        ///< of the Gaussian that makes the label weights; 0: no weights
  bool optimise = true;               ///< perturbation and exudation
  int threads = 1;                    ///< more than 1: CGAL's parallel mesher
  double sliver_bound_deg = 0;        ///< perturbation and exudation stop there; 0: CGAL's default, as far as they can
};

/// What a run took besides the mesh.
struct CgalTimes {
  double weights_s = 0;  ///< wall seconds of the label weights
  double mesh_s = 0;     ///< wall seconds of the mesher and its optimisers
};

/// CGAL's version, e.g. "5.5.1".
const char* cgal_version();

/// Meshes all labels but 0; the mesh lies in the image's physical space (LPS, mm) and carries the image's labels.
/// The image is cropped to its labelled voxels and four voxels of background, since CGAL takes the space beyond
/// the outermost voxel centres for background: tissue at the image's border is not cut off.
/// With one thread the same bytes in every run. Memory: with weights one copy of the crop a label.
/// Throws InvalidInput when nothing is labelled, MeshingFailed when CGAL gives no tetrahedron.
TetMesh mesh_with_cgal(const LabelImage& image, const CgalOptions& options, CgalTimes& times);

}  // namespace anatomesh::peers
