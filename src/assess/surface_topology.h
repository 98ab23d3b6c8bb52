// Topology and smoothness of a triangle surface.
#pragma once

#include <span>

#include "anatomesh/assess.h"
#include "assess/surface.h"

namespace anatomesh::assess_detail {

/// Fills the fields of `topology` that speak of the surface. Cost: n log n in its triangles.
void measure_surface(std::span<const Triangle> surface, std::span<const Vec3> points_mm, Topology& topology);

}  // namespace anatomesh::assess_detail
