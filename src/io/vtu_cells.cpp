#include "io/vtu_cells.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cstring>
#include <exception>
#include <string>
#include <type_traits>

#include "io/vtk_session.h"

namespace anatomesh {
namespace {

/// The number type of a C++ type that VTK has arrays of.
template <typename Value>
constexpr NumberType number_type_of() {
  if constexpr (std::is_floating_point_v<Value>) {
    return sizeof(Value) == 4 ? NumberType::f32 : NumberType::f64;
  } else {
    constexpr bool is_signed = std::is_signed_v<Value>;
    switch (sizeof(Value)) {
      case 1:
        return is_signed ? NumberType::i8 : NumberType::u8;
      case 2:
        return is_signed ? NumberType::i16 : NumberType::u16;
      case 4:
        return is_signed ? NumberType::i32 : NumberType::u32;
      default:
        return is_signed ? NumberType::i64 : NumberType::u64;
    }
  }
}

NumberArray numbers_of(vtkDataArray& array) {
  NumberArray result;
  switch (array.GetDataType()) {
    vtkTemplateMacro(result.type = number_type_of<VTK_TT>());
    default:
      return result;
  }
  result.bytes.resize(static_cast<std::size_t>(array.GetNumberOfValues()) * bytes_of(result.type));
  if (!result.bytes.empty()) std::memcpy(result.bytes.data(), array.GetVoidPointer(0), result.bytes.size());
  return result;
}

std::vector<std::int64_t> integers_of(vtkDataArray& array) {
  std::vector<std::int64_t> result(static_cast<std::size_t>(array.GetNumberOfValues()));
  const auto copy = [&]<typename Value>(const Value* values) {
    for (std::size_t n = 0; n < result.size(); ++n)
      result[n] = static_cast<std::int64_t>(values[n]);  // NOLINT(bugprone-signed-char-misuse)
  };
  switch (array.GetDataType()) {
    vtkTemplateMacro(copy(static_cast<const VTK_TT*>(array.GetVoidPointer(0))));
    default:
      break;
  }
  return result;
}

void take_names(vtkFieldData& data, CellArrays& to) {
  vtkDataArray* const values = data.GetArray(kNameArrays.values);
  auto* const names = vtkStringArray::SafeDownCast(data.GetAbstractArray(kNameArrays.names));
  if (values == nullptr || names == nullptr) return;
  to.label_values = numbers_of(*values);
  for (vtkIdType n = 0; n < names->GetNumberOfValues(); ++n) to.label_names.push_back(names->GetValue(n));
  if (vtkDataArray* const colours = data.GetArray(kNameArrays.colours)) to.label_colours = numbers_of(*colours);
}

CellArrays arrays_of(vtkUnstructuredGrid& grid) {
  CellArrays result;
  result.points_mm.resize(static_cast<std::size_t>(grid.GetNumberOfPoints()));
  for (std::size_t n = 0; n < result.points_mm.size(); ++n) {
    double p[3];
    grid.GetPoint(static_cast<vtkIdType>(n), p);
    result.points_mm[n] = {p[0], p[1], p[2]};
  }
  if (grid.GetCells() != nullptr && grid.GetCellTypesArray() != nullptr) {
    result.offsets = integers_of(*grid.GetCells()->GetOffsetsArray());
    result.corners = integers_of(*grid.GetCells()->GetConnectivityArray());
    result.types = integers_of(*grid.GetCellTypesArray());
  }
  vtkCellData& data = *grid.GetCellData();
  for (int n = 0; n < data.GetNumberOfArrays(); ++n) {
    vtkDataArray* const array = data.GetArray(n);
    if (array == nullptr || array->GetNumberOfComponents() != 1) continue;
    result.arrays.push_back({array->GetName() != nullptr ? array->GetName() : "", numbers_of(*array)});
  }
  take_names(*grid.GetFieldData(), result);
  return result;
}

}  // namespace

CellArrays vtu_cells(const std::filesystem::path& path) {
  const VtkSession vtk_session;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  if (reader->CanReadFile(path.c_str()) == 0) throw_damaged(path, "it is no unstructured grid in VTK's XML format");
  try {
    reader->SetFileName(path.c_str());
    reader->Update();
  } catch (const std::exception& error) {
    throw_damaged(path, error.what());
  }
  const std::string error = vtk_session.first_error();
  if (!error.empty() || reader->GetErrorCode() != 0) throw_damaged(path, error.empty() ? "VTK cannot read it" : error);
  vtkUnstructuredGrid* const grid = reader->GetOutput();
  if (grid == nullptr || grid->GetPoints() == nullptr) throw_damaged(path, "it has no points");
  return arrays_of(*grid);
}

}  // namespace anatomesh
