#include "io/numbered_mesh.h"

#include <algorithm>
#include <limits>
#include <string>

#include "anatomesh/errors.h"
#include "io/cell_arrays.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

template <typename Numbered>
void sort(const std::filesystem::path& path, const std::string& kind, std::vector<Numbered>& things) {
  if (!std::ranges::is_sorted(things, {}, &Numbered::number)) {
    std::ranges::stable_sort(things, {}, &Numbered::number);
  }
  const auto twice = std::ranges::adjacent_find(things, {}, &Numbered::number);
  if (twice != things.end()) throw_damaged(path, kind + " " + number_text(twice->number) + " is there twice");
}

/// Position of the point of a number among the sorted points; their size where there is none.
std::size_t position_of(std::int64_t number, const std::vector<NumberedPoint>& points) {
  const auto found = std::ranges::lower_bound(points, number, {}, &NumberedPoint::number);
  if (found == points.end() || found->number != number) return points.size();
  return static_cast<std::size_t>(found - points.begin());
}

/// As position_of(), without a search where the numbers have no gaps.
std::size_t quick_position_of(std::int64_t number, const std::vector<NumberedPoint>& points) {
  if (points.empty() || number < points.front().number) return points.size();
  const std::uint64_t guess = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(points.front().number);
  return guess < points.size() && points[guess].number == number ? guess : position_of(number, points);
}

}  // namespace

void sort_by_number(const std::filesystem::path& path, NumberedMesh& mesh) {
  if (mesh.tets.empty()) throw InvalidInput(in_quotes(path) + " has no linear tetrahedra");
  if (mesh.points.size() > std::numeric_limits<VertexId>::max()) {
    throw InvalidInput(in_quotes(path) + " has " + number_text(mesh.points.size()) +
                       " points; at most 4294967295 can be read");
  }
  sort(path, "point", mesh.points);
  sort(path, "tetrahedron", mesh.tets);
}

TetMesh tet_mesh_from(const std::filesystem::path& path, NumberedMesh mesh) {
  sort_by_number(path, mesh);
  TetMesh result;
  result.tets.reserve(mesh.tets.size());
  result.labels.reserve(mesh.tets.size());
  for (const NumberedTet& tet : mesh.tets) {
    auto& corners = result.tets.emplace_back();
    for (std::size_t n = 0; n < corners.size(); ++n) {
      const std::size_t position = quick_position_of(tet.corners[n], mesh.points);
      if (position == mesh.points.size()) {
        throw_damaged(path, "tetrahedron " + number_text(tet.number) + " refers to point " +
                                number_text(tet.corners[n]) + ", which is not there");
      }
      corners[n] = static_cast<VertexId>(position);
    }
    result.labels.push_back(tet.label);
  }
  result.points_mm.reserve(mesh.points.size());
  for (const NumberedPoint& point : mesh.points) result.points_mm.push_back(point.place_mm);
  return result;
}

}  // namespace anatomesh
