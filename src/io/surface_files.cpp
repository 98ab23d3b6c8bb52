#include "io/surface_files.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/output_file.h"
#include "io/surface.h"
#include "io/surface_bytes.h"
#include "io/whole_files.h"

namespace anatomesh {
namespace {

struct SurfaceFormat {
  std::string_view extension;
  std::string (*bytes)(const Surface&);
};

constexpr std::array kFormats = {
    SurfaceFormat{".stl", &stl_bytes},
    SurfaceFormat{".ply", &ply_bytes},
    SurfaceFormat{".obj", &obj_bytes},
    SurfaceFormat{".vtp", &vtp_bytes},
};

const SurfaceFormat& format_of(const std::filesystem::path& path) {
  const auto found = std::ranges::find(kFormats, file_extension(path), &SurfaceFormat::extension);
  if (found != kFormats.end()) return *found;
  throw InvalidInput("cannot write the surfaces " + in_quotes(path) +
                     ": the extension must be .stl, .ply, .obj or .vtp");
}

/// "brain_Liver.stl" for "brain.stl".
std::filesystem::path file_of_tissue(const std::filesystem::path& path, const std::string& name) {
  return path.parent_path() / (path.stem().string() + "_" + name + path.extension().string());
}

}  // namespace

void write_stl(const std::filesystem::path& path, const TetMesh& mesh) {
  write_whole_file(path, stl_bytes(interface_surface(mesh)));
}
void write_ply(const std::filesystem::path& path, const TetMesh& mesh) {
  write_whole_file(path, ply_bytes(interface_surface(mesh)));
}
void write_obj(const std::filesystem::path& path, const TetMesh& mesh) {
  write_whole_file(path, obj_bytes(interface_surface(mesh)));
}
void write_vtp(const std::filesystem::path& path, const TetMesh& mesh) {
  write_whole_file(path, vtp_bytes(interface_surface(mesh)));
}

void check_tissue_surfaces_writable(const std::filesystem::path& path) {
  format_of(path);
  check_writable(path);
}

std::vector<std::filesystem::path> write_tissue_surfaces(const std::filesystem::path& path, const TetMesh& mesh) {
  const SurfaceFormat& format = format_of(path);
  const std::map<Label, std::string> names = tissue_names(mesh);
  std::vector<FileBytes> files;
  for (const auto& [label, surface] : tissue_surfaces(mesh)) {
    files.push_back({file_of_tissue(path, names.at(label)), format.bytes(surface)});
  }
  write_whole_files(files);
  std::vector<std::filesystem::path> written;
  for (const FileBytes& file : files) written.push_back(file.target);
  return written;
}

}  // namespace anatomesh
