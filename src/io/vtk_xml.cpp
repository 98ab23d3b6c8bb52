#include "io/vtk_xml.h"

#include <vtkDataObject.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedIntArray.h>
#include <vtkXMLWriter.h>

#include "io/cell_arrays.h"

namespace anatomesh {

vtkSmartPointer<vtkPoints> vtk_points(const std::vector<Vec3>& points_mm) {
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  coordinates->SetNumberOfTuples(static_cast<vtkIdType>(points_mm.size()));
  double* out = coordinates->GetPointer(0);
  for (const Vec3& p : points_mm) {
    for (std::size_t axis = 0; axis < 3; ++axis) *out++ = p[axis];
  }
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(coordinates);
  return points;
}

void add_names(vtkFieldData& to, const LabelTable& names) {
  if (names.empty()) return;
  vtkNew<vtkUnsignedIntArray> values;
  vtkNew<vtkUnsignedCharArray> texts;
  vtkNew<vtkUnsignedCharArray> colours;
  values->SetName(kNameArrays.values);
  texts->SetName(kNameArrays.names);
  colours->SetName(kNameArrays.colours);
  colours->SetNumberOfComponents(3);
  for (const auto& [label, entry] : names) {
    values->InsertNextValue(label);
    for (const char c : entry.name) texts->InsertNextValue(static_cast<unsigned char>(c));
    texts->InsertNextValue(0);
    if (entry.colour) colours->InsertNextTypedTuple(entry.colour->data());
  }
  to.AddArray(values);
  to.AddArray(texts);
  if (colours->GetNumberOfTuples() == values->GetNumberOfTuples()) to.AddArray(colours);
}

std::string xml_bytes(vtkXMLWriter& writer, vtkDataObject& data) {
  constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
  writer.SetInputDataObject(&data);
  writer.SetDataModeToAppended();
  writer.EncodeAppendedDataOff();
  writer.SetHeaderTypeToUInt64();
  writer.SetCompressorTypeToZLib();
  writer.SetCompressionLevel(1);
  writer.SetBlockSize(kBlockBytes);
  writer.WriteToOutputStringOn();
  return writer.Write() == 1 ? writer.GetOutputString() : std::string();
}

}  // namespace anatomesh
