// Ctrl-C and a request to terminate: message, status 130, nothing written.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "anatomesh/io.h"
#include "apps/process.h"
#include "support/test_images.h"

namespace anatomesh::testing {
namespace {

class Cancel : public ::testing::TestWithParam<int> {};

TEST_P(Cancel, a_running_mesh_command_leaves_no_file) {
  const ScratchFolder folder;
  write_label_image(folder / "image.nrrd", random_blobs(3, 128, 60));
  write_file(folder / "old.vtu", "an older mesh");
  const auto before = folder.files();
  for (const char* name : {"mesh.vtu", "old.vtu"}) {
    // The plain progress lines start with the percentage: from 5 % on the mesher itself is at work.
    const ProcessResult result = run_program({"mesh", folder / "image.nrrd", "-o", folder / name, "--bcc-size", "4",
                                              "--max-memory", "16", "--report", folder / "report.json"},
                                             {.interrupt_at = "  5 %", .interrupt_signal = GetParam()});
    EXPECT_EQ(result.status, 130) << result.err;
    EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(folder.files(), before);
  }
}

INSTANTIATE_TEST_SUITE_P(signals, Cancel, ::testing::Values(SIGINT, SIGTERM),
                         [](const auto& test) { return test.param == SIGINT ? "interrupt" : "terminate"; });

}  // namespace
}  // namespace anatomesh::testing
