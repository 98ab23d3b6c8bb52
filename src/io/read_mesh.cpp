#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/cell_arrays.h"
#include "io/legacy_vtk.h"
#include "io/output_file.h"
#include "io/vtu_cells.h"

namespace anatomesh {

TetMesh read_mesh(const std::filesystem::path& path) {
  require_readable(path);
  const std::string extension = file_extension(path);
  if (extension == ".vtu") return tet_mesh_from(path, read_vtu(path));
  if (extension == ".vtk") return tet_mesh_from(path, read_legacy_vtk(path));
  throw InvalidInput("cannot read the mesh " + in_quotes(path) + ": the extension must be .vtu or .vtk");
}

}  // namespace anatomesh
