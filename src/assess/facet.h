// A triangle made ready for distances to it.
#pragma once

#include "anatomesh/types.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {

struct Facet {
  Vec3 a, b, c;
  Vec3 normal;  ///< unit length; zero for a triangle without area

  Facet(Vec3 a_, Vec3 b_, Vec3 c_) : a(a_), b(b_), c(c_), normal(cross(b_ - a_, c_ - a_)) {
    const double length = norm(normal);
    normal = length > 0 ? 1 / length * normal : Vec3{};
  }

  /// Squared distance to p if it is below reach_squared, else some value that is not.
  double distance_squared(Vec3 p, double reach_squared) const;
};

/// Squared distance of p to the segment from a to b.
inline double segment_distance_squared(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a, to_p = p - a;
  const double length_squared = norm_squared(along);
  const double t = length_squared > 0 ? dot(to_p, along) / length_squared : 0;
  return norm_squared(to_p - (t < 0 ? 0 : t > 1 ? 1 : t) * along);
}

inline double Facet::distance_squared(Vec3 p, double reach_squared) const {
  const double height = dot(normal, p - a);
  const double height_squared = height * height;
  if (height_squared >= reach_squared) return height_squared;
  // Over an edge's outer side the nearest point lies on such an edge; over none it lies inside.
  const bool flat = normal == Vec3{};
  double nearest = reach_squared;
  bool inside = true;
  const auto look_at_edge = [&](Vec3 from, Vec3 to) {
    if (!flat && dot(cross(normal, to - from), p - from) >= 0) return;
    inside = false;
    const double d = segment_distance_squared(p, from, to);
    nearest = d < nearest ? d : nearest;
  };
  look_at_edge(a, b);
  look_at_edge(b, c);
  look_at_edge(c, a);
  return inside ? height_squared : nearest;
}

}  // namespace anatomesh::assess_detail
