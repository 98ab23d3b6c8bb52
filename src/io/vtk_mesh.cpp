#include "io/vtk_mesh.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkNew.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedIntArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <limits>
#include <string>

#include "anatomesh/errors.h"
#include "io/element_nodes.h"
#include "io/legacy_vtk.h"
#include "io/output_file.h"
#include "io/vtk_session.h"
#include "io/vtk_xml.h"
#include "io/vtu_cells.h"

namespace anatomesh {
namespace {

/// Cells with 32-bit ids where they fit, which halves what there is to compress.
template <typename IdArray>
vtkSmartPointer<vtkCellArray> vtk_cells(const TetMesh& mesh) {
  using Id = typename IdArray::ValueType;
  vtkNew<IdArray> offsets, connectivity;
  const std::size_t nodes = nodes_per_tet(mesh);
  offsets->SetNumberOfValues(static_cast<vtkIdType>(mesh.tets.size()) + 1);
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(nodes * mesh.tets.size()));
  Id* offset = offsets->GetPointer(0);
  for (std::size_t n = 0; n <= mesh.tets.size(); ++n) *offset++ = static_cast<Id>(nodes * n);
  Id* node = connectivity->GetPointer(0);
  for (std::size_t n = 0; n < mesh.tets.size(); ++n) {
    for (const VertexId vertex : nodes_of_tet(mesh, n)) *node++ = static_cast<Id>(vertex);
  }
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(offsets, connectivity);
  return cells;
}

vtkSmartPointer<vtkUnstructuredGrid> vtk_grid(const TetMesh& mesh) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(vtk_points(mesh.points_mm));
  constexpr std::size_t kMost32 = std::numeric_limits<vtkTypeInt32>::max();
  const bool fits_32 = nodes_per_tet(mesh) * mesh.tets.size() <= kMost32 && mesh.points_mm.size() <= kMost32;
  grid->SetCells(is_quadratic(mesh) ? VTK_QUADRATIC_TETRA : VTK_TETRA,
                 fits_32 ? vtk_cells<vtkTypeInt32Array>(mesh) : vtk_cells<vtkTypeInt64Array>(mesh));
  vtkNew<vtkUnsignedIntArray> labels;
  labels->SetName("label");
  labels->SetNumberOfValues(static_cast<vtkIdType>(mesh.labels.size()));
  std::copy(mesh.labels.begin(), mesh.labels.end(), labels->GetPointer(0));
  grid->GetCellData()->SetScalars(labels);
  add_names(*grid->GetFieldData(), mesh.names);
  return grid;
}

std::string vtu_bytes(vtkUnstructuredGrid* grid) {
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  return xml_bytes(*writer, *grid);
}

std::string vtk_bytes(vtkUnstructuredGrid* grid) {
  vtkNew<vtkUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  writer->SetHeader("tetrahedral mesh, tissue in cell array label");
  writer->SetFileTypeToBinary();
  writer->SetFileVersion(vtkUnstructuredGridWriter::VTK_LEGACY_READER_VERSION_4_2);  // what other tools read
  writer->WriteToOutputStringOn();
  return writer->Write() == 1 ? writer->GetOutputStdString() : std::string();
}

void write_grid(const std::filesystem::path& path, const TetMesh& mesh, std::string (*bytes_of)(vtkUnstructuredGrid*)) {
  std::string bytes;
  {
    const VtkSession vtk_session;
    bytes = bytes_of(vtk_grid(mesh));
    if (bytes.empty()) throw IoError("cannot write " + in_quotes(path) + ": " + vtk_session.first_error());
  }
  write_whole_file(path, bytes);
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const TetMesh& mesh) { write_grid(path, mesh, &vtu_bytes); }
void write_legacy_vtk(const std::filesystem::path& path, const TetMesh& mesh) { write_grid(path, mesh, &vtk_bytes); }

TetMesh read_vtu(const std::filesystem::path& path) { return tet_mesh_from(path, vtu_cells(path)); }
TetMesh read_legacy_vtk(const std::filesystem::path& path) { return tet_mesh_from(path, legacy_vtk_cells(path)); }

}  // namespace anatomesh
