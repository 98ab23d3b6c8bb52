#include "apps/convert_command.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "anatomesh/io.h"
#include "anatomesh/quadratic.h"
#include "apps/exit_status.h"
#include "apps/images.h"
#include "apps/label_names.h"
#include "apps/mesh_options.h"
#include "apps/messages.h"
#include "apps/output_paths.h"
#include "apps/text_table.h"

namespace anatomesh::apps {
namespace {

struct ConvertRequest {
  std::filesystem::path in;
  std::filesystem::path out;
  std::filesystem::path names;  ///< empty: none
  bool per_tissue = false;
  int order = 0;  ///< 0: that of the mesh
};

/// Writes the mesh, or the surface of each tissue; returns the files.
std::vector<std::filesystem::path> write(const ConvertRequest& request, const TetMesh& mesh) {
  if (request.per_tissue) return write_tissue_surfaces(request.out, mesh);
  write_mesh(request.out, mesh);
  return {request.out};
}

int run_convert(const ConvertRequest& request, const Interrupt& interrupt) {
  request.per_tissue ? require_surface_output(request.out) : require_mesh_output(request.out);
  require_different_files({request.names, request.out});
  const LabelTable names = read_names(request.names);
  TetMesh mesh = read_mesh(request.in);
  if (request.order == 1) mesh = linear_mesh(mesh);
  if (request.order == 2) mesh = quadratic_mesh(mesh);
  const std::size_t named = take_names(mesh.names, names, {mesh.labels.begin(), mesh.labels.end()});
  const std::string warning = foreign_table(request.names, named, quoted({request.in}));
  interrupt.throw_if_requested();
  const std::vector<std::filesystem::path> files = write(request, mesh);
  if (!warning.empty()) print_warning(warning);
  for (const std::filesystem::path& file : files) {
    fmt::print("{}", field(request.per_tissue ? "surface" : "mesh",
                           fmt::format("{}, {}", file.string(), byte_size(size_on_disk(file)))));
  }
  fmt::print("{}", field("tetrahedra", grouped(mesh.tets.size())));
  return kDone;
}

}  // namespace

Command add_convert_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("convert", "Rewrite a mesh in the format of another extension");
  const auto request = std::make_shared<ConvertRequest>();
  command->add_option("MESH", request->in, "mesh to read")->required();
  add_names_option(*command, request->names);
  command->add_option("OUT", request->out, "mesh to write; .stl, .ply, .obj and .vtp hold its surfaces")->required();
  command->add_flag("--per-tissue", request->per_tissue,
                    "one closed surface a tissue: OUT.stl stands for OUT_NAME.stl, or OUT_label_7.stl without a name");
  add_order_option(*command, "make linear tetrahedra (1) or quadratic ones (2) [as they are]", request->order);
  return {command, [request](const Interrupt& interrupt) { return run_convert(*request, interrupt); }};
}

}  // namespace anatomesh::apps
