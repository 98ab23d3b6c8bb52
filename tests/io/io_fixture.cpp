#include "io/io_fixture.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

namespace anatomesh::testing {
namespace fs = std::filesystem;

IoTest::IoTest() {
  const ::testing::TestInfo* const info = ::testing::UnitTest::GetInstance()->current_test_info();
  folder_ = fs::temp_directory_path() / ("anatomesh-" + std::string(info->test_suite_name()) + "-" + info->name() +
                                         "-" + std::to_string(::getpid()));
  fs::create_directories(folder_);
  ::testing::internal::CaptureStderr();
}

IoTest::~IoTest() {
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

fs::path IoTest::put(const std::string& name, std::string_view bytes) const {
  const fs::path file = in_folder(name);
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

std::string IoTest::folder_listing() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  std::string listing;
  for (const std::string& name : names) listing += (listing.empty() ? "" : " ") + name;
  return listing;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace anatomesh::testing
