// The program: parses the command line, runs one command, turns errors into messages and exit statuses.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/version.h"
#include "apps/check_command.h"
#include "apps/command.h"
#include "apps/convert_command.h"
#include "apps/exit_status.h"
#include "apps/info_command.h"
#include "apps/mesh_command.h"
#include "apps/mesh_options.h"
#include "apps/messages.h"

namespace anatomesh::apps {
namespace {

/// Runs a command; every error becomes one message and a status.
int run(const Command& command, const Interrupt& interrupt) {
  const auto fail = [](int status, const std::string& sentence) {
    print_error(with_option_names(sentence));
    return status;
  };
  try {
    const int status = command.run(interrupt);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      return fail(kBadInput, "standard output cannot be written; what the command found is lost");
    return status;
  } catch (const Cancelled&) {
    print_note("nothing was written");
    return kInterrupted;
  } catch (const InvalidOption& error) {
    return fail(kWrongUsage, error.what());
  } catch (const InvalidInput& error) {
    return fail(kBadInput, error.what());
  } catch (const IoError& error) {
    return fail(kBadInput, error.what());
  } catch (const MeshingFailed& error) {
    return fail(kMeshingFailed, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kMeshingFailed, "memory ran out; a larger --bcc-size or --min-size, or fewer --labels, needs less");
  } catch (const std::exception& error) {
    return fail(kMeshingFailed, fmt::format("unexpected: {}", error.what()));
  }
}

/// The commands that the user may choose from.
std::vector<Command> add_commands(CLI::App& program) {
  return {add_mesh_command(program), add_check_command(program), add_convert_command(program),
          add_info_command(program)};
}

/// What is wrong with the command line, in one sentence.
std::string usage_fault(const CLI::App& program, const CLI::ParseError& error) {
  if (!program.get_subcommands().empty()) return error.what();
  const std::vector<std::string> left_over = program.remaining();
  std::string names;
  for (const CLI::App* command : program.get_subcommands({}))
    names += (names.empty() ? "" : ", ") + command->get_name();
  if (left_over.empty()) return fmt::format("a command is missing; there are {}", names);
  return fmt::format("'{}' is not a command; there are {}", left_over.front(), names);
}

/// For --help and --version prints what was asked for; else one message.
int report_parse_error(const CLI::App& program, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return program.exit(error);
  std::string asked = "anatomesh";
  for (const CLI::App* command : program.get_subcommands()) asked += " " + command->get_name();
  print_error(fmt::format("{} (see {} --help)", usage_fault(program, error), asked));
  return kWrongUsage;
}

int main_of_program(int argc, char** argv) {
  const Interrupt interrupt;
  CLI::App program("Makes multi-tissue tetrahedral meshes of segmented medical images.", "anatomesh");
  program.set_version_flag("--version", std::string("anatomesh ") + version());
  program.require_subcommand(1);
  const std::vector<Command> commands = add_commands(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report_parse_error(program, error);
  }
  for (const Command& command : commands)
    if (command.parser->parsed()) return run(command, interrupt);
  return kWrongUsage;
}

}  // namespace
}  // namespace anatomesh::apps

int main(int argc, char** argv) {
  try {
    return anatomesh::apps::main_of_program(argc, argv);
  } catch (const std::exception& error) {
    anatomesh::apps::print_error(error.what());
    return anatomesh::apps::kMeshingFailed;
  }
}
