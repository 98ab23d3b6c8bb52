// What local changes of a mesh must not change, by brute force.
#pragma once

#include <cstddef>
#include <map>
#include <ostream>
#include <set>

#include "mesh/tissue_mesh.h"

namespace anatomesh::testing {

/// Numbers that are the same for two meshes of the same topology.
struct TissueTopology {
  /// Euler number of the simplices at which all of these tissues meet, for every set of tissues that meet somewhere:
  /// one tissue's region, the interface of two, the junctions of three, the points of four.
  std::map<std::set<TissueId>, int> euler;
  std::map<TissueId, std::size_t> components;     ///< tetrahedra connected by faces
  std::map<TissueId, std::size_t> surface_parts;  ///< faces to others, connected by edges
  bool operator==(const TissueTopology&) const = default;
};
std::ostream& operator<<(std::ostream& out, const TissueTopology& topology);
TissueTopology topology_of(const TissueMesh& mesh);

/// Tissues with edges at which other than two of their surface's faces meet.
std::set<TissueId> nonmanifold_tissues(const TissueMesh& mesh);

/// Volume of each tissue.
std::map<TissueId, double> volumes_of(const TissueMesh& mesh);

/// Corners of the faces between different tissues, with the tissues: the same for two meshes with the same interfaces.
std::set<std::pair<std::array<TissueId, 2>, std::array<std::array<double, 3>, 3>>> interfaces_of(
    const TissueMesh& mesh);

}  // namespace anatomesh::testing
