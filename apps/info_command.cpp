#include "apps/info_command.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/io.h"
#include "anatomesh/label_list.h"
#include "apps/exit_status.h"
#include "apps/label_names.h"
#include "apps/text_table.h"

namespace anatomesh::apps {
namespace {

/// "right-handed" or "left-handed": whether the index axes form a right-handed frame.
std::string handedness(const Mat3& m) {
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return determinant > 0 ? "right-handed" : "left-handed";
}

/// Where the index axes point, as three letters of L, R, P, A, S, I; "oblique" is added where an axis is off by
/// more than a degree.
std::string orientation(const Mat3& direction) {
  constexpr std::array<std::string_view, 3> kLetters = {"RL", "AP", "IS"};  // towards -, + of L, P, S
  constexpr double kCosineOfOneDegree = 0.99984769515639127;
  std::string letters;
  bool oblique = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t row = 0;
    for (std::size_t r = 1; r < 3; ++r)
      if (std::abs(direction[r][axis]) > std::abs(direction[row][axis])) row = r;
    letters += kLetters[row][direction[row][axis] > 0 ? 1 : 0];
    oblique = oblique || std::abs(direction[row][axis]) < kCosineOfOneDegree;
  }
  return letters + (oblique ? ", oblique" : "");
}

std::string image_table(const LabelImage& image, const LabelCounts& labels) {
  const auto triple = [](Vec3 v) { return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z); };
  const double voxel_ml = image.spacing_mm.x * image.spacing_mm.y * image.spacing_mm.z / 1000;
  std::string text;
  text += field("size", fmt::format("{} x {} x {}, {} voxels", image.size[0], image.size[1], image.size[2],
                                    grouped(image.voxels.size())));
  text += field("spacing mm", triple(image.spacing_mm));
  text += field("origin mm, LPS", triple(image.origin_mm));
  for (std::size_t row = 0; row < 3; ++row) {
    const auto& r = image.direction[row];
    text += field(row == 0 ? "direction" : "", fmt::format("{:9.6f} {:9.6f} {:9.6f}", r[0], r[1], r[2]));
  }
  text += field("axes", fmt::format("{}, {}", orientation(image.direction), handedness(image.direction)));
  text += field("labels", std::to_string(labels.size()));
  std::vector<std::string> titles = {"label", "voxels", "volume ml"};
  if (!image.names.empty()) titles.emplace_back(kNameTitle);
  std::vector<std::vector<std::string>> rows;
  for (const auto& [label, voxels] : labels) {
    rows.push_back({std::to_string(label), grouped(voxels), fixed(static_cast<double>(voxels) * voxel_ml, 3)});
    if (!image.names.empty()) rows.back().push_back(shown_name(image.names, label));
  }
  return text + "\n" + columns(titles, rows);
}

int run_info(const std::filesystem::path& path) {
  const ImageFile file = read_label_image(path);
  std::string text = field("image", path.string()) + image_table(file.image, count_labels(file.image));
  for (const std::string& note : file.notes) text += fmt::format("note: {}\n", note);
  fmt::print("{}", text);
  return kDone;
}

}  // namespace

Command add_info_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand("info", "Show an image's size, place in space and labels");
  const auto image = std::make_shared<std::filesystem::path>();
  command->add_option("IMAGE", *image, "segmented image, or a folder with one DICOM series")->required();
  return {command, [image](const Interrupt&) { return run_info(*image); }};
}

}  // namespace anatomesh::apps
