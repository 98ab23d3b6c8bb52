// Small named label images that every floor's tests share. All are deterministic, at most 32 voxels
// along an axis, and of 1 mm spacing in the identity frame unless a function below changes that.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "anatomesh/label_image.h"

namespace anatomesh::testing {

/// An image of the given size whose voxel (i, j, k) is label_at(i, j, k).
LabelImage make_image(std::array<std::size_t, 3> size, const std::function<Label(int i, int j, int k)>& label_at);

/// A ball (label 1) in the middle of a cube of background.
LabelImage sphere(int radius_vox = 9);

/// Three balls inside one another; labels 3, 70000 and 2^32 - 1 from outside in.
LabelImage nested_spheres();

/// Two cubes (labels 1, 2) that share a square face of 10 x 10 voxels.
LabelImage two_touching_cubes();

/// A ball in three sectors (labels 1, 2, 300) that meet in a line, together with the background.
LabelImage three_label_junction();

/// A ball in four sectors (labels 1, 2, 3, 4) around the corners of a tetrahedron, meeting in one point.
LabelImage four_label_point();

/// A plate of one voxel's thickness.
LabelImage one_voxel_sheet();

/// Branching tubes (label 2) of about three voxels' width inside an ellipsoid (label 1).
LabelImage vessel_tree();

/// Labels 1, 2, 3 that touch faces, an edge and a corner of the image.
LabelImage labels_at_border();

/// Four labels that fill the image: no background at all.
LabelImage no_background_box();

/// A single labelled voxel in the middle of a small image.
LabelImage one_voxel();

/// An image of one voxel, labelled.
LabelImage only_one_voxel();

/// A ring: one component with one hole through it (Euler number 0).
LabelImage torus();

/// A ball with a closed cavity of background in it.
LabelImage hollow_sphere();

/// Cubes of `block_vox` voxels, background, label 1 and label 2 by turns along every axis.
LabelImage checkerboard(int block_vox = 3);

/// Voxels drawn evenly from 0 .. labels by a generator of its own: the same on every platform.
LabelImage noise(std::uint64_t seed, int size_vox = 8, int labels = 3);

/// Random blobs (nearest of a few random seeds, some of them background): smooth enough to mesh well.
LabelImage random_blobs(std::uint64_t seed, int size_vox = 24, int blobs = 8);

/// The same voxels with spacing 0.7 x 1.1 x 2.5 mm.
LabelImage anisotropic(LabelImage image);

/// The same voxels under a rotation about a skew axis, with an origin far from zero.
LabelImage oblique(LabelImage image);

/// The same voxels with the first index axis pointing the other way (determinant -1).
LabelImage left_handed(LabelImage image);

/// An image with the name under which a failing test reports it.
struct NamedImage {
  std::string name;  ///< snake_case, usable in a test's name
  LabelImage image;
};

/// One of each shape above, as made.
std::vector<NamedImage> all_shapes();

/// all_shapes(), and the anisotropic, oblique and left-handed version of each.
std::vector<NamedImage> all_test_images();

}  // namespace anatomesh::testing
