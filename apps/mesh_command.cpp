#include "apps/mesh_command.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "anatomesh/assess.h"
#include "anatomesh/errors.h"
#include "anatomesh/image_to_mesh.h"
#include "anatomesh/io.h"
#include "anatomesh/label_list.h"
#include "apps/exit_status.h"
#include "apps/images.h"
#include "apps/json_report.h"
#include "apps/label_names.h"
#include "apps/mesh_options.h"
#include "apps/mesh_summary.h"
#include "apps/messages.h"
#include "apps/output_paths.h"
#include "apps/progress_bar.h"

namespace anatomesh::apps {
namespace {

struct MeshArguments {
  std::vector<std::filesystem::path> images;
  std::filesystem::path mesh;
  std::filesystem::path names;   ///< empty: none
  std::filesystem::path report;  ///< empty: none
  MeshRequest request;
  bool quiet = false;
  bool verbose = false;

  Verbosity verbosity() const { return quiet ? Verbosity::quiet : verbose ? Verbosity::verbose : Verbosity::normal; }
};

/// Calls `work` and appends the time it took.
template <class Work>
auto timed(std::vector<StageTime>& times, const char* stage, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  auto result = work();
  times.push_back({stage, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()});
  return result;
}

/// Everything, against the image.
Assessment measure(const LabelImage& image, const Result& result, const Progress& progress) {
  AssessOptions options;
  options.frame = result.options.frame;
  options.min_dihedral_deg = result.options.deform.min_dihedral_deg;
  options.max_dihedral_deg = result.options.deform.max_dihedral_deg;
  options.min_mean_ratio = result.options.deform.min_mean_ratio;
  return assess(result.mesh, &image, options, progress);
}

/// image_to_mesh(), with the files named in what it has to say about the image.
Result mesh_of(const std::vector<std::filesystem::path>& files, const LabelImage& image, const Options& options,
               const Progress& progress) {
  const auto about_file = [&](const Error& error) { return fmt::format("{}: {}", quoted(files), error.what()); };
  try {
    Result result = image_to_mesh(image, options, progress);
    if (result.mesh.tets.empty()) throw MeshingFailed("no tetrahedron could be made; a smaller --min-size may do");
    return result;
  } catch (const InvalidOption&) {
    throw;
  } catch (const InvalidInput& error) {
    throw InvalidInput(about_file(error));
  } catch (const MeshingFailed& error) {
    throw MeshingFailed(about_file(error));
  }
}

/// Puts the user's names over those of the image.
void name_labels(ImageFile& file, const MeshArguments& arguments, const LabelTable& names, const LabelCounts& present) {
  std::set<Label> labels;
  for (const auto& [label, voxels] : present) labels.insert(label);
  const std::size_t named = take_names(file.image.names, names, labels);
  const std::string warning = foreign_table(arguments.names, named, quoted(arguments.images));
  if (!warning.empty()) file.notes.push_back(warning);
}

int run_mesh(const MeshArguments& arguments, const Interrupt& interrupt) {
  Options options = options_of(arguments.request);
  check_options(options);
  require_mesh_output(arguments.mesh);
  require_text_output(arguments.report);
  for (const std::filesystem::path& input : arguments.images)
    require_different_files({input, arguments.mesh, arguments.report});
  require_different_files({arguments.names, arguments.mesh, arguments.report});
  const LabelTable names = read_names(arguments.names);

  std::vector<StageTime> times;
  ProgressBar bar(arguments.verbosity());
  bar.show("read", 0);
  ImageFile file = timed(times, "read", [&] { return read_images(arguments.images); });
  interrupt.throw_if_requested();
  const LabelCounts present = count_labels(file.image);
  resolve_labels(options, arguments.request.ranges, present);
  name_labels(file, arguments, names, present);

  const double meshing_ends = arguments.report.empty() ? 0.9 : 0.6;
  const Result result = mesh_of(arguments.images, file.image, options, bar.part(0.05, meshing_ends, interrupt.token()));
  times.insert(times.end(), result.times.begin(), result.times.end());
  std::optional<Assessment> assessment;
  const ShapeSummary shapes = timed(times, "measure", [&] {
    if (!arguments.report.empty())
      assessment = measure(file.image, result, bar.part(meshing_ends, 0.95, interrupt.token()));
    return summarise_shapes(result.mesh);
  });
  interrupt.throw_if_requested();

  bar.show("write", 0.95);
  timed(times, "write", [&] { return write_mesh(arguments.mesh, result.mesh), 0; });
  bar.finish();
  const MeshSummary summary = {arguments.images, arguments.mesh, size_on_disk(arguments.mesh), &result, shapes, times};
  if (assessment) write_text_file(arguments.report, mesh_report_json({summary, file, *assessment}));
  for (const auto& sentences : {file.notes, result.warnings})
    for (const std::string& sentence : sentences) print_warning(sentence);
  if (!arguments.quiet) fmt::print("{}", mesh_table(summary));
  return kDone;
}

}  // namespace

Command add_mesh_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("mesh", "Make a tetrahedral mesh of a segmented image");
  const auto arguments = std::make_shared<MeshArguments>();
  command
      ->add_option("IMAGE", arguments->images,
                   "segmented image, or a folder with one DICOM series; of several, each is a mask of one tissue, "
                   "labelled 1, 2, 3 ... in their order, where the later wins")
      ->required();
  command->add_option("-o,--output", arguments->mesh, "mesh to write; the extension names the format")
      ->type_name("MESH")
      ->required();
  add_mesh_options(*command, arguments->request);
  add_names_option(*command, arguments->names);
  command->add_option("--report", arguments->report, "write everything measured and the options used to this file")
      ->type_name("FILE.json");
  command->add_flag("--quiet", arguments->quiet, "no progress and no table; warnings and errors only");
  command->add_flag("--verbose", arguments->verbose, "also the time each stage takes");
  return {command, [arguments](const Interrupt& interrupt) { return run_mesh(*arguments, interrupt); }};
}

}  // namespace anatomesh::apps
