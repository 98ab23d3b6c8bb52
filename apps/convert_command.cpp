#include "apps/convert_command.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "anatomesh/io.h"
#include "apps/exit_status.h"
#include "apps/output_paths.h"
#include "apps/text_table.h"

namespace anatomesh::apps {
namespace {

struct ConvertRequest {
  std::filesystem::path in;
  std::filesystem::path out;
};

int run_convert(const ConvertRequest& request, const Interrupt& interrupt) {
  require_mesh_output(request.out);
  const TetMesh mesh = read_mesh(request.in);
  interrupt.throw_if_requested();
  write_mesh(request.out, mesh);
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
  return {command, [request](const Interrupt& interrupt) { return run_convert(*request, interrupt); }};
}

}  // namespace anatomesh::apps
