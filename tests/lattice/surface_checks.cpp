#include "lattice/surface_checks.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace anatomesh::testing {
namespace {

/// Number of groups of 0 .. n-1 that these pairs make.
std::size_t groups(std::size_t n, const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
  std::vector<std::size_t> group(n);
  std::iota(group.begin(), group.end(), 0u);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : pairs) {
      const std::size_t least = std::min(group[a], group[b]);
      changed = changed || group[a] != group[b];
      group[a] = group[b] = least;
    }
  }
  return std::set<std::size_t>(group.begin(), group.end()).size();
}

/// Whether these faces, all at vertex v, are one fan around it.
bool is_one_fan(const std::vector<Face>& faces, VertexId v) {
  std::map<VertexId, std::vector<std::size_t>> at_edge;  // by the edge's other end
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const VertexId w : faces[f]) {
      if (w != v) at_edge[w].push_back(f);
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> joined;
  for (const auto& [w, users] : at_edge) {
    if (users.size() != 2) return false;
    joined.emplace_back(users[0], users[1]);
  }
  return groups(faces.size(), joined) == 1;
}

}  // namespace

std::set<VertexId> singular_vertices_of(std::span<const SharedFace> faces, const Inside& inside) {
  std::map<VertexId, std::vector<Face>> surface;
  for (const SharedFace& face : faces) {
    if (std::count_if(face.tets.begin(), face.tets.end(), inside) != 1) continue;
    for (const VertexId v : face.vertices) surface[v].push_back(face.vertices);
  }
  std::set<VertexId> singular;
  for (const auto& [v, around] : surface) {
    if (!is_one_fan(around, v)) singular.insert(v);
  }
  return singular;
}

std::size_t pieces_of(std::span<const SharedFace> faces, std::size_t tets, const Inside& inside) {
  std::vector<std::vector<std::size_t>> neighbours(tets);
  for (const SharedFace& face : faces) {
    if (face.tets.size() != 2 || !inside(face.tets[0]) || !inside(face.tets[1])) continue;
    neighbours[face.tets[0]].push_back(face.tets[1]);
    neighbours[face.tets[1]].push_back(face.tets[0]);
  }
  std::vector<char> seen(tets, 0);
  std::size_t pieces = 0;
  for (std::size_t t = 0; t < tets; ++t) {
    if (seen[t] || !inside(t)) continue;
    ++pieces;
    std::vector<std::size_t> stack = {t};
    seen[t] = 1;
    while (!stack.empty()) {
      const std::size_t at = stack.back();
      stack.pop_back();
      for (const std::size_t next : neighbours[at]) {
        if (!std::exchange(seen[next], 1)) stack.push_back(next);
      }
    }
  }
  return pieces;
}

std::size_t image_components_of(const TissueImage& image, TissueId tissue) {
  std::vector<char> open(image.voxels.size());
  for (std::size_t v = 0; v < open.size(); ++v) open[v] = image.voxels[v] == tissue;
  std::size_t components = 0;
  const auto nx = static_cast<std::size_t>(image.size[0]), ny = static_cast<std::size_t>(image.size[1]);
  for (std::size_t v = 0; v < open.size(); ++v) {
    if (!open[v]) continue;
    ++components;
    std::vector<std::size_t> stack = {v};
    open[v] = 0;
    while (!stack.empty()) {
      const std::size_t at = stack.back();
      stack.pop_back();
      const int i = static_cast<int>(at % nx), j = static_cast<int>(at / nx % ny), k = static_cast<int>(at / nx / ny);
      for (int n = 0; n < 27; ++n) {
        const std::array<int, 3> to = {i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1};
        if (!image.contains(to[0], to[1], to[2])) continue;
        const std::size_t next = image.offset(to[0], to[1], to[2]);
        if (std::exchange(open[next], 0)) stack.push_back(next);
      }
    }
  }
  return components;
}

}  // namespace anatomesh::testing
