#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkUnsignedIntArray.h>
#include <vtkXMLPolyDataWriter.h>

#include "anatomesh/errors.h"
#include "io/surface_bytes.h"
#include "io/vtk_session.h"
#include "io/vtk_xml.h"

namespace anatomesh {
namespace {

vtkSmartPointer<vtkCellArray> triangles_of(const Surface& surface) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (const SurfacePart& part : surface.parts) {
    for (const auto& [a, b, c] : part.triangles) cells->InsertNextCell({vtkIdType{a}, vtkIdType{b}, vtkIdType{c}});
  }
  return cells;
}

vtkSmartPointer<vtkUnsignedIntArray> label_array(const Surface& surface, const char* name, Label SurfacePart::*side) {
  auto labels = vtkSmartPointer<vtkUnsignedIntArray>::New();
  labels->SetName(name);
  for (const SurfacePart& part : surface.parts) {
    for (std::size_t n = 0; n < part.triangles.size(); ++n) labels->InsertNextValue(part.*side);
  }
  return labels;
}

}  // namespace

std::string vtp_bytes(const Surface& surface) {
  const VtkSession vtk_session;
  vtkNew<vtkPolyData> data;
  data->SetPoints(vtk_points(surface.points_mm));
  data->SetPolys(triangles_of(surface));
  data->GetCellData()->SetScalars(label_array(surface, "label", &SurfacePart::inside));
  data->GetCellData()->AddArray(label_array(surface, "label_outside", &SurfacePart::outside));
  add_names(*data->GetFieldData(), surface.names);
  vtkNew<vtkXMLPolyDataWriter> writer;
  const std::string bytes = xml_bytes(*writer, *data);
  if (bytes.empty()) throw IoError("cannot write a .vtp file: " + vtk_session.first_error());
  return bytes;
}

}  // namespace anatomesh
