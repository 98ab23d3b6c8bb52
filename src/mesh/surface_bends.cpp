#include "mesh/surface_bends.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "anatomesh/interfaces.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

// Surfaces with less between the normals of two faces (cosine) have an edge there, and corners with less between their
// normal and that of a face lie on one.
constexpr double kSmoothFaces = 0.5, kSmoothCorner = 0.766;

/// An edge as a side of one face of an interface.
struct FaceSide {
  VertexId from, to;
  std::uint32_t interface;
  Vec3 normal;  // of the face, of length 1
};

/// Things of an interface, or of a kind of junction, at a vertex.
std::uint64_t key_of(VertexId vertex, std::size_t what) { return std::uint64_t{vertex} << 32u | what; }

/// From the middle of a chord to a curve that leaves its ends in these directions, scaled as the chord is; where one is
/// not known it mirrors the other.
Vec3 bow(Vec3 chord, std::optional<Vec3> leaving, std::optional<Vec3> arriving) {
  if (!leaving && !arriving) return {};
  if (!leaving) leaving = 2 * chord - *arriving;
  if (!arriving) arriving = 2 * chord - *leaving;
  const Vec3 middle = 0.125 * (*leaving - *arriving);  // of the cubic with these ends
  return middle - dot(middle, chord) / norm_squared(chord) * chord;
}

class SurfaceBends {
 public:
  explicit SurfaceBends(const TetMesh& mesh) : points_(mesh.points_mm) {
    const std::vector<Interface> interfaces = interfaces_of(mesh);
    for (std::size_t n = 0; n < interfaces.size(); ++n) {
      for (const TetFace face : interfaces[n].faces) add_face(corners_of(mesh, face), n);
    }
    std::ranges::sort(sides_, {}, [](const FaceSide& s) { return std::tie(s.from, s.to, s.interface); });
    for_each_edge([&](std::span<const FaceSide> sides) { add_junction(sides); });
  }

  std::vector<EdgeBend> all() const {
    std::vector<EdgeBend> bends;
    for_each_edge([&](std::span<const FaceSide> sides) {
      const Vec3 bow = is_junction(sides) ? junction_bow(sides) : surface_bow(sides);
      if (norm_squared(bow) > 0) bends.push_back({sides[0].from, sides[0].to, bow});
    });
    return bends;
  }

 private:
  /// The two neighbours of a vertex along a line where surfaces meet.
  struct LineEnds {
    std::array<VertexId, 2> others = {};
    std::size_t count = 0;
  };

  void add_face(const std::array<VertexId, 3>& face, std::size_t interface) {
    const Vec3 normal = cross(points_[face[1]] - points_[face[0]], points_[face[2]] - points_[face[0]]);
    const double length = norm(normal);
    if (!(length > 0)) return;
    for (std::size_t n = 0; n < 3; ++n) {
      const VertexId here = face[n], next = face[(n + 1) % 3], other = face[(n + 2) % 3];
      const Vec3 a = points_[next] - points_[here], b = points_[other] - points_[here];
      normals_[key_of(here, interface)] += 1 / (norm_squared(a) * norm_squared(b)) * normal;
      const auto [low, high] = std::minmax(here, next);
      sides_.push_back({low, high, static_cast<std::uint32_t>(interface), 1 / length * normal});
    }
  }

  template <typename Visit>
  void for_each_edge(const Visit& visit) const {
    for (std::size_t begin = 0, end = 0; begin < sides_.size(); begin = end) {
      while (end < sides_.size() && sides_[end].from == sides_[begin].from && sides_[end].to == sides_[begin].to) ++end;
      visit(std::span(sides_).subspan(begin, end - begin));
    }
  }

  static bool is_junction(std::span<const FaceSide> sides) {
    return sides.size() != 2 || sides[0].interface != sides[1].interface;
  }

  static std::vector<std::uint32_t> interfaces_around(std::span<const FaceSide> sides) {
    std::vector<std::uint32_t> around;
    for (const FaceSide& side : sides) around.push_back(side.interface);
    return around;
  }

  void add_junction(std::span<const FaceSide> sides) {
    if (!is_junction(sides)) return;
    const auto [from, to] = std::pair(sides[0].from, sides[0].to);
    const std::size_t kind =
        junction_kinds_.try_emplace(interfaces_around(sides), junction_kinds_.size()).first->second;
    for (const auto& [here, other] : {std::pair(from, to), std::pair(to, from)}) {
      LineEnds& line = lines_[key_of(here, kind)];
      if (line.count < 2) line.others[line.count] = other;
      ++line.count;
    }
  }

  Vec3 surface_bow(std::span<const FaceSide> sides) const {
    if (dot(sides[0].normal, sides[1].normal) < kSmoothFaces) return {};
    const Vec3 chord = points_[sides[0].to] - points_[sides[0].from];
    const auto along_surface_at = [&](VertexId vertex) -> std::optional<Vec3> {
      const Vec3 sum = normals_.at(key_of(vertex, sides[0].interface));
      const Vec3 normal = 1 / norm(sum) * sum;
      for (const FaceSide& side : sides) {
        if (!(dot(normal, side.normal) >= kSmoothCorner)) return std::nullopt;
      }
      return chord - dot(chord, normal) * normal;
    };
    return bow(chord, along_surface_at(sides[0].from), along_surface_at(sides[0].to));
  }

  Vec3 junction_bow(std::span<const FaceSide> sides) const {
    const std::size_t kind = junction_kinds_.at(interfaces_around(sides));
    const Vec3 chord = points_[sides[0].to] - points_[sides[0].from];
    const auto along_line_at = [&](VertexId here, VertexId next) -> std::optional<Vec3> {
      const LineEnds& line = lines_.at(key_of(here, kind));
      if (line.count != 2) return std::nullopt;
      const VertexId before = line.others[line.others[0] == next ? 1 : 0];
      // The tangent of the circle through the three.
      const Vec3 to_here = points_[here] - points_[before], to_next = points_[next] - points_[here];
      Vec3 tangent = norm_squared(to_next) * to_here + norm_squared(to_here) * to_next;
      tangent = 1 / norm(tangent) * tangent;
      const double share = dot(tangent, chord);
      if (!(std::abs(share) >= kSmoothCorner * norm(chord))) return std::nullopt;
      return share * tangent;
    };
    return bow(chord, along_line_at(sides[0].from, sides[0].to), along_line_at(sides[0].to, sides[0].from));
  }

  const std::vector<Vec3>& points_;
  std::vector<FaceSide> sides_;  // by edge
  std::unordered_map<std::uint64_t, Vec3> normals_;
  std::map<std::vector<std::uint32_t>, std::size_t> junction_kinds_;  // by the interfaces that meet
  std::unordered_map<std::uint64_t, LineEnds> lines_;
};

}  // namespace

std::vector<EdgeBend> surface_bends(const TetMesh& mesh) { return SurfaceBends(mesh).all(); }

}  // namespace anatomesh
