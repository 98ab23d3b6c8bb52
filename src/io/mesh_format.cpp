#include "io/mesh_format.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/abaqus_mesh.h"
#include "io/febio_mesh.h"
#include "io/gmsh_mesh.h"
#include "io/medit_mesh.h"
#include "io/mesh_groups.h"
#include "io/nastran_mesh.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/surface_files.h"
#include "io/tetgen_mesh.h"
#include "io/vtk_mesh.h"
#include "io/xdmf_mesh.h"

namespace anatomesh {
namespace {

constexpr std::array kFormats = {
    MeshFormat{".vtu", "VTK XML unstructured grid", &write_vtu, &read_vtu},
    MeshFormat{".vtk", "VTK legacy unstructured grid", &write_legacy_vtk, &read_legacy_vtk},
    MeshFormat{".inp", "Abaqus and CalculiX input", &write_abaqus, &read_abaqus},
    MeshFormat{".bdf", "Nastran bulk data", &write_nastran, &read_nastran, kLargestNastranNumber},
    MeshFormat{".feb", "FEBio model", &write_febio, &read_febio},
    MeshFormat{".node", "TetGen nodes", &write_tetgen, &read_tetgen},
    MeshFormat{".ele", "TetGen elements", &write_tetgen, &read_tetgen},
    MeshFormat{".msh", "Gmsh", &write_gmsh, &read_gmsh, kLargestGroup},
    MeshFormat{".mesh", "MEDIT", &write_medit, &read_medit, kLargestGroup},
    MeshFormat{".xdmf", "XDMF 3 with HDF5", &write_xdmf, &read_xdmf},
    MeshFormat{".stl", "STL surface", &write_stl, nullptr},
    MeshFormat{".ply", "PLY surface", &write_ply, nullptr},
    MeshFormat{".obj", "OBJ surface", &write_obj, nullptr},
    MeshFormat{".vtp", "VTK XML surface", &write_vtp, nullptr},
};

/// Extensions of the formats that suit: ".a, .b or .c".
std::string listed(const std::function<bool(const MeshFormat&)>& suits) {
  std::vector<std::string> known;
  for (const MeshFormat& format : kFormats) {
    if (suits(format)) known.emplace_back(format.extension);
  }
  std::string text = known.front();
  for (std::size_t n = 1; n < known.size(); ++n) text += (n + 1 < known.size() ? ", " : " or ") + known[n];
  return text;
}

const MeshFormat* format_of(const std::filesystem::path& path) {
  const auto found = std::ranges::find(kFormats, file_extension(path), &MeshFormat::extension);
  return found == kFormats.end() ? nullptr : &*found;
}

const MeshFormat& format_to_write(const std::filesystem::path& path) {
  if (const MeshFormat* format = format_of(path)) return *format;
  throw InvalidInput("cannot write the mesh " + in_quotes(path) + ": the extension must be " +
                     listed([](const MeshFormat&) { return true; }));
}

}  // namespace

std::span<const MeshFormat> mesh_formats() { return kFormats; }

std::vector<std::string> mesh_extensions() {
  std::vector<std::string> extensions;
  for (const MeshFormat& format : kFormats) extensions.emplace_back(format.extension);
  return extensions;
}

void check_mesh_writable(const std::filesystem::path& path) {
  format_to_write(path);
  check_writable(path);
}

void write_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
  const MeshFormat& format = format_to_write(path);
  check_writable(path);
  if (mesh.labels.size() != mesh.tets.size()) {
    throw InvalidInput("cannot write the mesh " + in_quotes(path) + ": it has " + number_text(mesh.labels.size()) +
                       " labels for " + number_text(mesh.tets.size()) + " tetrahedra; one for each is needed");
  }
  const auto largest = std::ranges::max_element(mesh.labels);
  if (largest != mesh.labels.end() && *largest > format.largest_label) {
    throw InvalidInput("cannot write the mesh " + in_quotes(path) + ": it has the label " + number_text(*largest) +
                       ", and " + std::string(format.name) + " holds labels up to " +
                       number_text(format.largest_label) + "; take another format");
  }
  format.write(path, mesh);
}

TetMesh read_mesh(const std::filesystem::path& path) {
  require_readable(path);
  const MeshFormat* format = format_of(path);
  if (format != nullptr && format->read != nullptr) return format->read(path);
  throw InvalidInput("cannot read the mesh " + in_quotes(path) + ": the extension must be " +
                     listed([](const MeshFormat& known) { return known.read != nullptr; }));
}

}  // namespace anatomesh
