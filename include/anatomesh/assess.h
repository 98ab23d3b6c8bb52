// How good a mesh is: the shape of its tetrahedra, its validity, its faithfulness to the image, its topology.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "anatomesh/label_image.h"
#include "anatomesh/progress.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Value of a measure that does not exist here (NaN), e.g. the angles of a tissue without tetrahedra.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Shape and size of a set of tetrahedra. Every real is kNotMeasured when there are none.
struct Quality {
  static constexpr std::size_t kDihedralBins = 36;  ///< of 5 degrees each, from 0

  std::uint64_t tets = 0;
  std::uint64_t vertices = 0;  ///< distinct ones of these tetrahedra
  std::uint64_t edges = 0;     ///< distinct ones

  double min_dihedral_deg = kNotMeasured;  ///< 0 to 180
  double max_dihedral_deg = kNotMeasured;  ///< 0 to 180
  /// Percentiles of the smallest dihedral angle of each tetrahedron.
  double dihedral_p0_1_deg = kNotMeasured, dihedral_p1_deg = kNotMeasured, dihedral_p5_deg = kNotMeasured,
         dihedral_median_deg = kNotMeasured;
  /// Share (0 to 1) of the tetrahedra with a dihedral angle below 5, 10, 15 degrees or above 165.
  double share_below_5_deg = kNotMeasured, share_below_10_deg = kNotMeasured, share_below_15_deg = kNotMeasured,
         share_above_165_deg = kNotMeasured;
  /// Number of dihedral angles (six a tetrahedron) in [5 i, 5 i + 5) degrees; 180 counts in the last bin.
  std::array<std::uint64_t, kDihedralBins> dihedral_histogram = {};

  double min_mean_ratio = kNotMeasured;       ///< 12 (3 V)^(2/3) / sum of squared edges; 0 (flat) to 1 (regular)
  double mean_mean_ratio = kNotMeasured;      ///< 0 to 1
  double min_scaled_jacobian = kNotMeasured;  ///< as Verdict defines it; -1 to 1 (regular)
  double mean_scaled_jacobian = kNotMeasured;
  double max_gradation = kNotMeasured;  ///< larger over smaller volume of two tetrahedra that share a face; >= 1
  double gradation_p99 = kNotMeasured;  ///< 99th percentile over those faces

  double min_edge_mm = kNotMeasured;
  double mean_edge_mm = kNotMeasured;  ///< over the distinct edges
  double max_edge_mm = kNotMeasured;
  double max_edge_ratio = kNotMeasured;  ///< longest over shortest edge of one tetrahedron; >= 1

  double volume_mm3 = 0;         ///< sum of the signed volumes
  std::uint64_t inverted = 0;    ///< volume below -1e-12 (longest edge)^3
  std::uint64_t degenerate = 0;  ///< volume within 1e-12 (longest edge)^3 of zero
};

/// Whether the tetrahedra fit together.
struct Conformity {
  /// Most tetrahedra are negatively oriented. All volumes then count with the opposite sign, so that
  /// Quality::inverted names those that disagree with the rest.
  bool negative_orientation = false;
  std::uint64_t background_tets = 0;  ///< of label 0; they take part in nothing else
  std::uint64_t faces = 0;            ///< distinct faces
  std::uint64_t outer_faces = 0;      ///< of one tetrahedron only
  std::uint64_t faces_in_more_than_two_tets = 0;
  std::uint64_t folded_tets = 0;         ///< with another on the same side of a shared face: they overlap
  std::uint64_t duplicate_vertices = 0;  ///< at the place of a vertex counted already, within 1e-9 of the mesh's size
  std::uint64_t unused_vertices = 0;     ///< of no tetrahedron (background ones count as use)
  /// Vertices that lie, within 1e-6 of the mean edge, inside an outer face or its edge, or at the middle
  /// of any edge, of tetrahedra that do not have them as a vertex.
  std::uint64_t hanging_vertices = 0;
  /// Outer faces with another tetrahedron a thousandth of their size before them: the mesh runs into itself, or
  /// nearly touches itself.
  std::uint64_t outer_faces_with_material_outside = 0;
  std::uint64_t voxel_centres_in_several_tets = 0;  ///< strictly inside more than one; 0 without an image
};

/// How far quadratic tetrahedra are curved; the rest of an assessment is about the straight ones between their corners.
struct Curves {
  std::uint64_t tets = 0;              ///< quadratic ones; 0: the mesh is linear, and nothing below is measured
  std::uint64_t curved_tets = 0;       ///< with an edge node off the middle of its chord by 1e-9 of it and more
  std::uint64_t folded = 0;            ///< whose Jacobian is not proved to be positive everywhere
  double min_jacobian = kNotMeasured;  ///< least Jacobian over that of the straight tetrahedron, a lower bound; <= 1
  double min_dihedral_deg = kNotMeasured;  ///< between tangent planes of faces at the corners; 0 to 180
  double max_dihedral_deg = kNotMeasured;  ///< 0 to 180
};

/// Distances from samples of one surface to all of another.
struct OneWayDistance {
  double mean_mm = kNotMeasured;  ///< weighted by the area each sample stands for
  double p95_mm = kNotMeasured;   ///< 95 % of the area is no farther
  double max_mm = kNotMeasured;
};

/// Distances between the surface of a tissue in the mesh and that of its voxels in the image (sides of voxels
/// against another label). kNotMeasured when one of the two is absent or distances were not asked for.
struct SurfaceDistance {
  OneWayDistance mesh_to_image;
  OneWayDistance image_to_mesh;
  double mean_mm = kNotMeasured;  ///< of both ways, weighted by area
  double p95_mm = kNotMeasured;   ///< the larger of both ways
  double max_mm = kNotMeasured;   ///< the larger of both ways
};

/// How a tissue's sub-mesh covers its voxels. S1: voxels whose centre lies in the tissue's tetrahedra (a centre on a
/// shared face belongs to the first of them in the mesh); S2: voxels with its label.
struct Fidelity {
  std::uint64_t image_voxels = 0;   ///< |S2|
  std::uint64_t mesh_voxels = 0;    ///< |S1|
  std::uint64_t common_voxels = 0;  ///< |S1 n S2|
  double f1 = 0;                    ///< common / mesh voxels; 0 to 1
  double f2 = 0;                    ///< common / image voxels; 0 to 1
  double dice = 0;                  ///< 2 common / (mesh + image voxels); 0 to 1
  double image_volume_mm3 = 0;
  double volume_error_percent = kNotMeasured;  ///< 100 (mesh volume / image volume - 1); -100 for a missing tissue
  SurfaceDistance distance;
};

/// Parts, holes and surface of a tissue, in the mesh and in the image.
struct Topology {
  std::uint64_t tet_components = 0;  ///< tetrahedra connected by faces
  std::int64_t volume_euler = 0;     ///< vertices - edges + faces - tetrahedra

  std::uint64_t surface_vertices = 0;
  std::uint64_t surface_edges = 0;
  std::uint64_t surface_faces = 0;
  double surface_area_mm2 = 0;
  std::uint64_t surface_components = 0;  ///< faces connected by edges
  std::int64_t surface_euler = 0;        ///< vertices - edges + faces
  bool closed = true;                    ///< every edge has an even number of faces
  std::uint64_t odd_edges = 0;           ///< edges with an odd number of faces
  std::uint64_t nonmanifold_edges = 0;   ///< edges with other than two faces
  /// Vertices whose faces fall into several fans (faces joined by edges at the vertex), or on a non-manifold edge.
  std::uint64_t nonmanifold_vertices = 0;
  std::uint64_t pinch_vertices = 0;            ///< several fans, but no non-manifold edge
  double normal_jump_mean_deg = kNotMeasured;  ///< angle between the normals of two faces that share an edge; 0 to 180
  double normal_jump_p95_deg = kNotMeasured;   ///< 95th percentile over the manifold edges

  // Of the voxels; 0 without an image.
  std::uint64_t image_components_6 = 0;   ///< voxels connected by sides
  std::uint64_t image_components_26 = 0;  ///< voxels connected by sides, edges or corners
  std::int64_t image_euler = 0;           ///< Euler number of the union of the closed voxels (26-connected)
};

/// One tissue, or the union of all.
struct TissueAssessment {
  Label label = 0;  ///< 0 for the union
  bool in_mesh = false;
  bool in_image = false;  ///< always false without an image
  Quality quality;
  Fidelity fidelity;  ///< meaningless without an image
  Topology topology;
};

/// The tissues in a few numbers. "Over tissues" counts those of the image.
struct Summary {
  std::uint64_t labels_in_image = 0;
  std::uint64_t labels_in_mesh = 0;
  std::vector<Label> missing_labels;  ///< in the image only, ascending
  std::vector<Label> extra_labels;    ///< in the mesh only, ascending; empty without an image
  std::vector<Label> open_surfaces;   ///< tissues of the mesh with an edge of an odd number of surface faces

  // Sums over the tissues of the mesh.
  std::uint64_t nonmanifold_edges = 0;
  std::uint64_t nonmanifold_vertices = 0;
  std::uint64_t pinch_vertices = 0;
  double normal_jump_mean_deg = kNotMeasured;  ///< over the manifold edges of all tissues' surfaces

  // kNotMeasured or 0 without an image.
  double min_dice = kNotMeasured;                    ///< over tissues
  double mean_dice = kNotMeasured;                   ///< over tissues
  double voxels_right = kNotMeasured;                ///< share of the labelled voxels that lie in their own tissue
  double worst_volume_error_percent = kNotMeasured;  ///< largest absolute one over tissues in image and mesh
  std::uint64_t component_mismatches_6 = 0;   ///< tissues in both with other than the image's 6-connected components
  std::uint64_t component_mismatches_26 = 0;  ///< the same, 26-connected
  std::uint64_t euler_mismatches = 0;         ///< tissues in both whose Euler number is not the image's
  double surface_mean_mm = kNotMeasured;      ///< weighted by the surface area of the tissues
  double surface_p95_mean_mm = kNotMeasured;  ///< mean over tissues
  double surface_p95_worst_mm = kNotMeasured;
  double surface_max_mm = kNotMeasured;
};

/// Everything measured of a mesh.
struct Assessment {
  bool has_image = false;
  bool has_distances = false;
  Conformity conformity;
  Curves curves;
  TissueAssessment whole;                 ///< all tissues as one; whole.quality is that of the mesh
  std::vector<TissueAssessment> tissues;  ///< ascending; the labels of the mesh and of the image
  Summary summary;
};

/// How to look at the mesh, and what it must keep.
struct AssessOptions {
  Frame frame = Frame::lps;  ///< space of the mesh
  bool distances = true;     ///< measure the surface distances (most of the time goes there)

  // Bounds of failed_guarantees(); rounding of coordinates is forgiven: 1e-6 degrees, 1e-9 of the mean ratio.
  double min_dihedral_deg = 20;
  double max_dihedral_deg = 150;
  double min_mean_ratio = 0.3;
};

/// Measures a mesh, against the image it was made from if there is one. Tetrahedra of label 0 are left out. Of
/// quadratic tetrahedra the corners count, but for the curves.
/// The result does not depend on the number of threads. Cost: some seconds for a million tetrahedra and as many
/// voxels as an ordinary image has, mostly for the distances; memory: about 300 bytes a tetrahedron, one byte a voxel.
/// Throws InvalidInput (a vertex that does not exist, a coordinate that is not finite, arrays whose sizes disagree),
/// Cancelled.
Assessment assess(const TetMesh& mesh, const LabelImage* image = nullptr, const AssessOptions& options = {},
                  const Progress& progress = {});

/// What Quality says of the shapes of a mesh's tetrahedra in four numbers.
struct ShapeSummary {
  double min_dihedral_deg = kNotMeasured;
  double max_dihedral_deg = kNotMeasured;
  double min_mean_ratio = kNotMeasured;
  double mean_mean_ratio = kNotMeasured;
};

/// Measures the shapes of a mesh, all of whose vertices exist, and nothing else. The result does not depend on the
/// number of threads. Cost: about 0.3 us a tetrahedron.
ShapeSummary summarise_shapes(const TetMesh& mesh);

/// One sentence for each guarantee that the mesh breaks; empty: all hold. Validity: positive volumes, no face in more
/// than two tetrahedra, no hanging, duplicate or unused vertex, no overlap; the bounds of the options, at the corners
/// of curved tetrahedra, too, and positive Jacobians of these; every label of the image and no other in the mesh; the
/// mesh in its place in the image (Dice of the union at least 0.5).
std::vector<std::string> failed_guarantees(const Assessment& assessment, const AssessOptions& options = {});

}  // namespace anatomesh
