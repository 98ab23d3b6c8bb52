#include "apps/convert_command.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "anatomesh/io.h"
#include "apps/exit_status.h"
#include "apps/images.h"
#include "apps/label_names.h"
#include "apps/messages.h"
#include "apps/output_paths.h"
#include "apps/text_table.h"

namespace anatomesh::apps {
namespace {

struct ConvertRequest {
  std::filesystem::path in;
  std::filesystem::path out;
  std::filesystem::path names;  ///< empty: none
};

int run_convert(const ConvertRequest& request, const Interrupt& interrupt) {
  require_mesh_output(request.out);
  require_different_files({request.names, request.out});
  const LabelTable names = read_names(request.names);
  TetMesh mesh = read_mesh(request.in);
  const std::size_t named = take_names(mesh.names, names, {mesh.labels.begin(), mesh.labels.end()});
  const std::string warning = foreign_table(request.names, named, quoted({request.in}));
  interrupt.throw_if_requested();
  write_mesh(request.out, mesh);
  if (!warning.empty()) print_warning(warning);
  fmt::print("{}", field("mesh", fmt::format("{}, {}", request.out.string(), byte_size(size_on_disk(request.out)))) +
                       field("tetrahedra", grouped(mesh.tets.size())));
  return kDone;
}

}  // namespace

Command add_convert_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("convert", "Rewrite a mesh in the format of another extension");
  const auto request = std::make_shared<ConvertRequest>();
  command->add_option("MESH", request->in, "mesh to read")->required();
  command->add_option("OUT", request->out, "mesh to write")->required();
  add_names_option(*command, request->names);
  return {command, [request](const Interrupt& interrupt) { return run_convert(*request, interrupt); }};
}

}  // namespace anatomesh::apps
