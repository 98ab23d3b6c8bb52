// A mesh as files have it: cells of any kind, arrays of any number type.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "anatomesh/tet_mesh.h"
#include "io/number_array.h"

namespace anatomesh {

/// One value a cell, with its name.
struct CellArray {
  std::string name;
  NumberArray values;
};

/// Names of the arrays in VTK's files that hold the label table: see vtk_mesh.h.
struct NameArrays {
  const char* values = "label_values";
  const char* names = "label_names";
  const char* colours = "label_colours";
};
inline constexpr NameArrays kNameArrays;

/// VTK's numbers for kinds of cells.
inline constexpr std::int64_t kVtkTetra = 10, kVtkQuadraticTetra = 24;

/// What a mesh file holds; nothing of it is checked yet.
struct CellArrays {
  std::vector<Vec3> points_mm;
  std::vector<std::int64_t> offsets;  ///< where each cell begins in corners, and where the last one ends
  std::vector<std::int64_t> corners;  ///< ids of points
  std::vector<std::int64_t> types;    ///< VTK's numbers for kinds of cells
  std::vector<CellArray> arrays;      ///< those with one component
  NumberArray label_values;           ///< of the label table, where there is one
  std::vector<std::string> label_names;
  NumberArray label_colours;  ///< red, green, blue for each
};

/// Which of the arrays holds the tissues, by its name and type; nothing where none does.
std::optional<std::size_t> label_array(const std::vector<CellArray>& arrays);

/// Takes the tetrahedra out, as read_mesh() says. Throws IoError (arrays that do not fit together),
/// InvalidInput (no tetrahedra, linear and quadratic ones, labels that are none).
TetMesh tet_mesh_from(const std::filesystem::path& path, CellArrays cells);

/// Throws InvalidInput unless a file has tetrahedra of one kind.
void check_kinds(const std::filesystem::path& path, std::size_t linear_tets, std::size_t quadratic_tets);

/// Throws IoError: "FILE is truncated or damaged: why".
[[noreturn]] void throw_damaged(const std::filesystem::path& path, const std::string& why);

}  // namespace anatomesh
