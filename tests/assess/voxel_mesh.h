// Meshes that the tests of the assessment know everything about.
#pragma once

#include <array>
#include <functional>

#include "anatomesh/label_image.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh::testing {

/// How a voxel is cut into tetrahedra; all fit those of the next voxel.
enum class VoxelCut {
  five,    ///< one regular in the middle, mirrored from voxel to voxel
  six,     ///< Kuhn's, around a diagonal
  twelve,  ///< from the centre to two triangles a side
};

/// The voxels themselves as a mesh in LPS: faithful in every measure.
TetMesh mesh_of_voxels(const LabelImage& image, VoxelCut cut = VoxelCut::six);

/// The mesh with each vertex moved by up to `distance_mm` along each axis, differently for each seed.
TetMesh jittered(TetMesh mesh, double distance_mm, unsigned seed = 1);

/// The mesh with every vertex moved.
TetMesh moved(TetMesh mesh, const std::function<Vec3(Vec3)>& to);

}  // namespace anatomesh::testing
