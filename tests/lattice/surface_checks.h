// Surfaces and pieces of tissues, counted by brute force.
#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <span>

#include "image/tissue_image.h"
#include "mesh/mesh_checks.h"

namespace anatomesh::testing {

/// Which tetrahedra belong to a region.
using Inside = std::function<bool(std::size_t tet)>;

/// Vertices at which the faces between a region and the rest (or nothing) are not one fan around it, each edge in two
/// of them: on edges in more than two such faces, and where surfaces touch at a point.
std::set<VertexId> singular_vertices_of(std::span<const SharedFace> faces, const Inside& inside);

/// Parts of a region that hang together by faces.
std::size_t pieces_of(std::span<const SharedFace> faces, std::size_t tets, const Inside& inside);

/// 26-connected components of a tissue in the image.
std::size_t image_components_of(const TissueImage& image, TissueId tissue);

}  // namespace anatomesh::testing
