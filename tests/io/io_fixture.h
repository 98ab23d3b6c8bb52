// What the tests of files share: a folder of their own, and silence as a rule.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace anatomesh::testing {

/// A test with an empty folder that is removed afterwards. Fails when anything is printed on standard error.
class IoTest : public ::testing::Test {
 public:
  ~IoTest() override;

 protected:
  IoTest();

  std::filesystem::path in_folder(const std::string& name) const { return folder_ / name; }

  /// Puts the bytes into a file of the folder and returns its path.
  std::filesystem::path put(const std::string& name, std::string_view bytes) const;

  /// Names in the folder, sorted, separated by spaces.
  std::string folder_listing() const;

 private:
  std::filesystem::path folder_;
};

/// All bytes of a file.
std::string bytes_of(const std::filesystem::path& file);

/// Fails where anything was printed on standard output since it was made.
class QuietStdout {
 public:
  QuietStdout() { ::testing::internal::CaptureStdout(); }
  ~QuietStdout() { EXPECT_EQ(::testing::internal::GetCapturedStdout(), ""); }
  QuietStdout(const QuietStdout&) = delete;
  QuietStdout& operator=(const QuietStdout&) = delete;
};

/// Runs the call, which must throw an Expected exception, and returns its message. The message must be one
/// sentence that names the file.
template <typename Expected>
std::string message_of(const std::filesystem::path& file, const std::function<void()>& call) {
  try {
    const QuietStdout quiet;
    call();
  } catch (const Expected& error) {
    std::string message = error.what();
    EXPECT_NE(message.find(file.filename().string()), std::string::npos) << message;
    EXPECT_EQ(message.find("0x"), std::string::npos) << message;
    return message;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "an exception of another kind: " << error.what();
    return "";
  }
  ADD_FAILURE() << "no exception for " << file;
  return "";
}

}  // namespace anatomesh::testing

/// Fails unless the text holds the part.
#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)
