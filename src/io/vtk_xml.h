// What our files in VTK's XML formats share.
#pragma once

#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

#include "anatomesh/label_table.h"

class vtkDataObject;
class vtkFieldData;
class vtkXMLWriter;

namespace anatomesh {

/// With 64-bit coordinates.
vtkSmartPointer<vtkPoints> vtk_points(const std::vector<Vec3>& points_mm);

/// Adds the label table to the field data, unless it is empty: see vtk_mesh.h.
void add_names(vtkFieldData& to, const LabelTable& names);

/// The whole file: appended, compressed. Empty where VTK fails.
std::string xml_bytes(vtkXMLWriter& writer, vtkDataObject& data);

}  // namespace anatomesh
