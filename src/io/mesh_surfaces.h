// The surfaces of a mesh by name, as solvers want them for contacts, loads and supports.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomesh/interfaces.h"

namespace anatomesh {

/// Faces of tetrahedra that belong together.
struct MeshSurface {
  std::string name;  ///< "brain_to_tumour", "brain_skin", "skin": the outer skin of all tissues
  std::vector<TetFace> faces;
};

/// One for each pair of tissues that meet, for each tissue's part of the outer skin, and for the whole skin. Names are
/// put together from those of the tissues, see set_names() and InterfaceNames, and have at most so many bytes.
std::vector<MeshSurface> mesh_surfaces(const TetMesh& mesh, const std::map<Label, std::string>& names,
                                       std::size_t most_bytes);

/// The vertices of some faces, ascending, each once.
std::vector<VertexId> vertices_of(const TetMesh& mesh, const std::vector<TetFace>& faces);

}  // namespace anatomesh
