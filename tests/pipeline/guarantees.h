// What every mesh must keep (docs/design.md, "Guarantees"), checked by brute force on the result alone.
#pragma once

#include "anatomesh/image_to_mesh.h"

namespace anatomesh::testing {

/// Valid: positive volumes, every face of one or two tetrahedra, no hanging, duplicate or unused vertex, no overlap.
void expect_valid(const LabelImage& image, const Result& result);

/// Angles and mean ratios within the bounds of the options (a lattice's own, tighter ones without iterations).
void expect_bounded(const Result& result);

/// The wanted labels of the image, each with its own value, and no other; what the result says of them is true.
void expect_complete(const LabelImage& image, const Result& result);

/// Most of each tissue's volume lies, in physical space, within a voxel of a voxel with its label.
void expect_in_place(const LabelImage& image, const Result& result);

/// What the result says of the tissues' fidelity is what assess() measures of its mesh.
void expect_fidelity_as_measured(const LabelImage& image, const Result& result);

/// Every tissue has the fidelity asked for.
void expect_faithful(const Result& result);

/// No tissue's surface has an edge or vertex at which it is not manifold.
void expect_manifold(const Result& result);

/// Every tissue of more than 50 voxels has as many components in the mesh as in the image (26-connected).
void expect_components(const LabelImage& image, const Result& result);

/// All of the above, except that a tissue may have less than the fidelity asked for as long as the result says so.
void expect_guarantees(const LabelImage& image, const Result& result);

/// Centres of voxels, as positions in LabelImage::voxels, strictly inside more than one tetrahedron.
std::size_t voxels_in_several_tets(const LabelImage& image, const Result& result);

}  // namespace anatomesh::testing
