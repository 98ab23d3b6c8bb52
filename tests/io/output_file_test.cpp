#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/io_fixture.h"
#include "support/test_images.h"
#include "support/test_meshes.h"

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public IoTest {};

/// While it lives, no file can grow beyond some bytes, as if the disk were full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_ = {};
};

TEST_F(OutputFiles, TextIsWrittenAndReplaced) {
  const auto file = in_folder("report.json");
  write_text_file(file, "one");
  write_text_file(file, "two");
  EXPECT_EQ(bytes_of(file), "two");
  EXPECT_EQ(folder_listing(), "report.json");
}

TEST_F(OutputFiles, NewFilesFollowTheUmask) {
  const mode_t before = ::umask(027);
  write_text_file(in_folder("report.json"), "one");
  ::umask(before);
  EXPECT_EQ(fs::status(in_folder("report.json")).permissions(), fs::perms(0640));
}

TEST_F(OutputFiles, LinksStayLinks) {
  put("real.json", "one");
  fs::create_symlink("real.json", in_folder("link.json"));
  write_text_file(in_folder("link.json"), "two");
  EXPECT_TRUE(fs::is_symlink(in_folder("link.json")));
  EXPECT_EQ(bytes_of(in_folder("real.json")), "two");
}

TEST_F(OutputFiles, DevicesAreWrittenToAndStayDevices) {
  if (!fs::is_character_file("/dev/full")) GTEST_SKIP() << "this machine has no /dev/full";
  write_text_file("/dev/null", "gone");
  EXPECT_SAYS(message_of<IoError>("/dev/full", [] { write_text_file("/dev/full", "text"); }), "No space left");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(OutputFiles, FullDiskLeavesWhatWasThere) {
  const auto mesh_file = in_folder("mesh.vtu"), text_file = in_folder("report.json"), image_file = in_folder("a.nrrd");
  for (const auto& file : {mesh_file, text_file, image_file}) put(file.filename().string(), "earlier");
  for (const rlim_t bytes : {0, 1, 100, 400}) {
    const FullDisk full(bytes);
    message_of<IoError>(mesh_file, [&] { write_mesh(mesh_file, corner_tet()); });
    message_of<IoError>(text_file, [&] { write_text_file(text_file, std::string(1000, 'x')); });
    message_of<IoError>(image_file, [&] { write_label_image(image_file, noise(1, 16)); });
  }
  for (const auto& file : {mesh_file, text_file, image_file}) EXPECT_EQ(bytes_of(file), "earlier");
  EXPECT_EQ(folder_listing(), "a.nrrd mesh.vtu report.json");
}

TEST_F(OutputFiles, UnwritablePlacesAreNamedBeforehand) {
  fs::create_directory(in_folder("folder.vtu"));
  put("plain", "a file");
  struct Case {
    fs::path path;
    const char* says;
  };
  const std::vector<Case> cases = {{in_folder("folder.vtu"), "it is a folder"},
                                   {in_folder("missing") / "mesh.vtu", "there is no folder"},
                                   {in_folder("plain") / "mesh.vtu", "is not a folder"}};
  for (const Case& c : cases) {
    EXPECT_SAYS(message_of<IoError>(c.path, [&] { check_writable(c.path); }), c.says);
    EXPECT_SAYS(message_of<IoError>(c.path, [&] { check_mesh_writable(c.path); }), c.says);
    EXPECT_SAYS(message_of<IoError>(c.path, [&] { write_mesh(c.path, corner_tet()); }), c.says);
    EXPECT_SAYS(message_of<IoError>(c.path, [&] { write_text_file(c.path, "text"); }), c.says);
  }
  EXPECT_EQ(folder_listing(), "folder.vtu plain");
}

TEST_F(OutputFiles, WritablePlacesLeaveNoTrace) {
  check_writable(in_folder("report.json"));
  check_mesh_writable(in_folder("mesh.vtk"));
  check_mesh_writable(in_folder("MESH.VTU"));
  check_mesh_writable("mesh.vtu");
  EXPECT_EQ(folder_listing(), "");
}

TEST_F(OutputFiles, UnknownExtensionsAreRefused) {
  for (const char* name : {"mesh", "mesh.xyz", "mesh.vtu.gz", ".vtu"}) {
    const auto file = in_folder(name);
    EXPECT_SAYS(message_of<InvalidInput>(file, [&] { check_mesh_writable(file); }), "extension must be .vtu, .vtk");
    EXPECT_SAYS(message_of<InvalidInput>(file, [&] { write_mesh(file, corner_tet()); }),
                "extension must be .vtu, .vtk");
  }
  for (const char* name : {"image", "image.xyz", "image.mhd", "image.hdr"}) {
    const auto image = in_folder(name);
    EXPECT_SAYS(message_of<InvalidInput>(image, [&] { write_label_image(image, one_voxel()); }), ".nii.gz");
  }
  EXPECT_EQ(folder_listing(), "");
}

}  // namespace
}  // namespace anatomesh::testing
