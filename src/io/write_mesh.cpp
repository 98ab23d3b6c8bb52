#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedIntArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/vtk_session.h"

namespace anatomesh {
namespace {

vtkSmartPointer<vtkPoints> vtk_points(const TetMesh& mesh) {
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  coordinates->SetNumberOfTuples(static_cast<vtkIdType>(mesh.points_mm.size()));
  double* out = coordinates->GetPointer(0);
  for (const Vec3& p : mesh.points_mm) {
    for (std::size_t axis = 0; axis < 3; ++axis) *out++ = p[axis];
  }
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(coordinates);
  return points;
}

/// Cells with 32-bit ids where they fit, which halves what there is to compress.
template <typename IdArray>
vtkSmartPointer<vtkCellArray> vtk_cells(const TetMesh& mesh) {
  using Id = typename IdArray::ValueType;
  vtkNew<IdArray> offsets, connectivity;
  offsets->SetNumberOfValues(static_cast<vtkIdType>(mesh.tets.size()) + 1);
  connectivity->SetNumberOfValues(4 * static_cast<vtkIdType>(mesh.tets.size()));
  Id* offset = offsets->GetPointer(0);
  for (std::size_t n = 0; n <= mesh.tets.size(); ++n) *offset++ = 4 * static_cast<Id>(n);
  Id* corner = connectivity->GetPointer(0);
  for (const auto& tet : mesh.tets) {
    for (const VertexId vertex : tet) *corner++ = static_cast<Id>(vertex);
  }
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(offsets, connectivity);
  return cells;
}

vtkSmartPointer<vtkUnstructuredGrid> vtk_grid(const TetMesh& mesh) {
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  grid->SetPoints(vtk_points(mesh));
  constexpr std::size_t kMost32 = std::numeric_limits<vtkTypeInt32>::max();
  const bool fits_32 = 4 * mesh.tets.size() <= kMost32 && mesh.points_mm.size() <= kMost32;
  grid->SetCells(VTK_TETRA, fits_32 ? vtk_cells<vtkTypeInt32Array>(mesh) : vtk_cells<vtkTypeInt64Array>(mesh));
  vtkNew<vtkUnsignedIntArray> labels;
  labels->SetName("label");
  labels->SetNumberOfValues(static_cast<vtkIdType>(mesh.labels.size()));
  std::copy(mesh.labels.begin(), mesh.labels.end(), labels->GetPointer(0));
  grid->GetCellData()->SetScalars(labels);
  return grid;
}

std::string vtu_bytes(vtkUnstructuredGrid* grid) {
  constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetHeaderTypeToUInt64();
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);
  writer->SetBlockSize(kBlockBytes);
  writer->WriteToOutputStringOn();
  return writer->Write() == 1 ? writer->GetOutputString() : std::string();
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

/// A mesh format that can be written.
struct MeshFormat {
  const char* extension;
  std::string (*bytes)(vtkUnstructuredGrid* grid);  ///< the whole file, empty on failure
};

constexpr std::array<MeshFormat, 2> kMeshFormats = {{{".vtu", &vtu_bytes}, {".vtk", &vtk_bytes}}};

const MeshFormat& format_for(const std::filesystem::path& path) {
  const std::string extension = file_extension(path);
  const auto found = std::find_if(kMeshFormats.begin(), kMeshFormats.end(),
                                  [&](const MeshFormat& format) { return extension == format.extension; });
  if (found != kMeshFormats.end()) return *found;
  std::string known;
  for (const MeshFormat& format : kMeshFormats) known += (known.empty() ? "" : " or ") + std::string(format.extension);
  throw InvalidInput("cannot write the mesh " + in_quotes(path) + ": the extension must be " + known);
}

}  // namespace

std::vector<std::string> mesh_extensions() {
  std::vector<std::string> extensions;
  extensions.reserve(kMeshFormats.size());
  for (const MeshFormat& format : kMeshFormats) extensions.emplace_back(format.extension);
  return extensions;
}

void check_mesh_writable(const std::filesystem::path& path) {
  format_for(path);
  check_writable(path);
}

void write_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
  const MeshFormat& format = format_for(path);
  check_writable(path);
  if (mesh.labels.size() != mesh.tets.size()) {
    throw InvalidInput("cannot write the mesh " + in_quotes(path) + ": it has " + number_text(mesh.labels.size()) +
                       " labels for " + number_text(mesh.tets.size()) + " tetrahedra; one for each is needed");
  }
  std::string bytes;
  {
    const VtkSession vtk_session;
    bytes = format.bytes(vtk_grid(mesh));
    if (bytes.empty()) throw IoError("cannot write " + in_quotes(path) + ": " + vtk_session.first_error());
  }
  write_whole_file(path, bytes);
}

}  // namespace anatomesh
