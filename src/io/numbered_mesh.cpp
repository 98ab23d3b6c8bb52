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

VertexId vertex_of(const std::filesystem::path& path, const NumberedMesh& mesh, const NumberedTet& tet,
                   std::int64_t number) {
  const std::size_t position = quick_position_of(number, mesh.points);
  if (position < mesh.points.size()) return static_cast<VertexId>(position);
  throw_damaged(path, "tetrahedron " + number_text(tet.number) + " refers to point " + number_text(number) +
                          ", which is not there");
}

}  // namespace

void NumberedMesh::add(std::int64_t number, std::span<const std::int64_t> nodes, Label label,
                       const EdgeNodeOrder& order) {
  NumberedTet& tet = tets.emplace_back();
  tet.number = number;
  tet.label = label;
  std::copy_n(nodes.begin(), tet.corners.size(), tet.corners.begin());
  if (nodes.size() == tet.corners.size()) return;
  tet.edge_nodes = static_cast<std::uint32_t>(edge_nodes.size());
  auto& between = edge_nodes.emplace_back();
  for (std::size_t n = 0; n < order.size(); ++n) between[order[n]] = nodes[tet.corners.size() + n];
}

void sort_by_number(const std::filesystem::path& path, NumberedMesh& mesh) {
  check_kinds(path, mesh.tets.size() - mesh.edge_nodes.size(), mesh.edge_nodes.size());
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
    const auto vertex = [&](std::int64_t number) { return vertex_of(path, mesh, tet, number); };
    std::ranges::transform(tet.corners, result.tets.emplace_back().begin(), vertex);
    result.labels.push_back(tet.label);
    if (tet.edge_nodes == NumberedTet::kLinear) continue;
    std::ranges::transform(mesh.edge_nodes[tet.edge_nodes], result.edge_nodes.emplace_back().begin(), vertex);
  }
  result.points_mm.reserve(mesh.points.size());
  for (const NumberedPoint& point : mesh.points) result.points_mm.push_back(point.place_mm);
  return result;
}

}  // namespace anatomesh
