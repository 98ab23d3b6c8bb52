// XDMF: the structure in XML, the numbers in HDF5. What FEniCS reads.
//
// NAME.xdmf has one grid, "mesh": the tetrahedra with the cell attribute "label"; NAME_facets.xdmf has one grid,
// "facets": the triangles of all interfaces with the cell attributes "interface" (1, 2, ...), "label" (inside) and
// "label_outside". One grid a file is what meshio reads; each with an .h5 file of its own name is what DOLFINx wants.
// The facets' points are those of NAME.h5, so that vertices have the same numbers in both.
//
// Names stand in the grid's Information, in the way of meshio's field data: <map key="NAME" dim="3">LABEL</map>, where
// dim is 2 and the value that of "interface" for the facets; attributes "colour", "inside" and "outside" go with it. In
// the .h5 files they are datasets under /labels and /interfaces.
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Four files, all or none: NAME.xdmf, NAME.h5, NAME_facets.xdmf, NAME_facets.h5. Throws IoError.
void write_xdmf(const std::filesystem::path& path, const TetMesh& mesh);

/// The first grid with tetrahedra and cell attributes, else the first with tetrahedra; numbers in XML or HDF5. Throws
/// IoError, InvalidInput: see read_mesh().
TetMesh read_xdmf(const std::filesystem::path& path);

}  // namespace anatomesh
