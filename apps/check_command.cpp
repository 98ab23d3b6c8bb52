#include "apps/check_command.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anatomesh/assess.h"
#include "anatomesh/io.h"
#include "anatomesh/label_list.h"
#include "apps/exit_status.h"
#include "apps/images.h"
#include "apps/json_report.h"
#include "apps/mesh_options.h"
#include "apps/messages.h"
#include "apps/output_paths.h"
#include "apps/progress_bar.h"
#include "apps/tables.h"
#include "apps/text_table.h"

namespace anatomesh::apps {
namespace {

struct CheckRequest {
  std::filesystem::path mesh;
  std::vector<std::filesystem::path> images;  ///< empty: none
  std::filesystem::path json;                 ///< empty: none
  AssessOptions options;
  std::vector<LabelRange> ranges;  ///< empty: all labels
  bool no_distances = false;
  bool all_rows = false;
  bool quiet = false;
};

/// Turns labels that the user did not ask for into background.
void keep_labels(LabelImage& image, const std::vector<LabelRange>& ranges) {
  if (ranges.empty()) return;
  const std::vector<Label> kept = select_labels(ranges, count_labels(image), "--labels");
  for (Label& label : image.voxels)
    if (!std::binary_search(kept.begin(), kept.end(), label)) label = 0;
}

std::optional<LabelImage> read_image(const CheckRequest& request) {
  if (request.images.empty()) return std::nullopt;
  ImageFile file = read_images(request.images);
  if (!request.quiet)
    for (const std::string& note : file.notes) print_note(note);
  keep_labels(file.image, request.ranges);
  return std::move(file.image);
}

void print_verdict(const std::vector<std::string>& failures) {
  if (failures.empty()) fmt::print("every guarantee holds\n");
  for (const std::string& failure : failures) fmt::print("FAILED  {}\n", failure);
}

int run_check(const CheckRequest& request, const Interrupt& interrupt) {
  require_text_output(request.json);
  require_different_files({request.json, request.mesh});
  for (const std::filesystem::path& image : request.images) require_different_files({request.json, image});
  ProgressBar bar(request.quiet ? Verbosity::quiet : Verbosity::normal);
  bar.show("read", 0);
  const TetMesh mesh = read_mesh(request.mesh);
  const std::optional<LabelImage> image = read_image(request);
  interrupt.throw_if_requested();
  AssessOptions options = request.options;
  options.distances = !request.no_distances;
  const Assessment assessment = assess(mesh, image ? &*image : nullptr, options, bar.part(0.1, 1, interrupt.token()));
  bar.finish();
  const std::vector<std::string> failures = failed_guarantees(assessment, options);
  LabelTable names = mesh.names;
  if (image) names.insert(image->names.begin(), image->names.end());
  if (!request.json.empty())
    write_text_file(request.json, check_json({request.mesh, request.images, options, assessment, failures, names}));
  fmt::print("{}\n{}", field("mesh", request.mesh.string()),
             assessment_tables(assessment, request.all_rows ? TissueRows::all : TissueRows::worst, names));
  print_verdict(failures);
  return failures.empty() ? kDone : kCheckFailed;
}

}  // namespace

Command add_check_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("check", "Measure a mesh; exit status 1 when it breaks a guarantee");
  const auto request = std::make_shared<CheckRequest>();
  command->add_option("MESH", request->mesh, "mesh to measure")->required();
  CLI::Option* image =
      command->add_option("--image", request->images, "the segmented image it was made of, or its masks in their order")
          ->type_name("IMAGE");
  command->add_option("--json", request->json, "write everything measured to this file")->type_name("FILE");
  add_frame_option(*command, request->options.frame);
  add_labels_option(*command, request->ranges).needs(image);
  add_bound_options(*command, request->options.min_dihedral_deg, request->options.max_dihedral_deg,
                    request->options.min_mean_ratio);
  command->add_flag("--no-distances", request->no_distances, "leave out the surface distances, which take longest");
  command->add_flag("--all", request->all_rows, "show every tissue, however many there are");
  command->add_flag("--quiet", request->quiet, "no progress");
  return {command, [request](const Interrupt& interrupt) { return run_check(*request, interrupt); }};
}

}  // namespace anatomesh::apps
