#include "io/text_cursor.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <system_error>
#include <utility>

#include "anatomesh/errors.h"
#include "io/cell_arrays.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

constexpr std::size_t kShown = 40;  // bytes of a wrong word in a message

bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

}  // namespace

std::string bytes_of_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw IoError("cannot open " + in_quotes(path));
  std::error_code none;
  const auto size = std::filesystem::file_size(path, none);
  std::string bytes(none ? 0 : size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

TextCursor::TextCursor(std::filesystem::path path) : path_(std::move(path)), bytes_(bytes_of_file(path_)) {}
TextCursor::TextCursor(std::filesystem::path path, std::string bytes)
    : path_(std::move(path)), bytes_(std::move(bytes)) {}

std::string_view TextCursor::word() {
  while (!at_end() && is_space(bytes_[at_])) ++at_;
  const std::size_t begin = at_;
  while (!at_end() && !is_space(bytes_[at_])) ++at_;
  return std::string_view(bytes_).substr(begin, at_ - begin);
}

std::string_view TextCursor::line() {
  const std::size_t begin = at_, end = std::min(bytes_.find('\n', begin), bytes_.size());
  at_ = std::min(end + 1, bytes_.size());
  std::string_view text = std::string_view(bytes_).substr(begin, end - begin);
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

bool TextCursor::at_line_end() {
  while (!at_end() && bytes_[at_] != '\n' && is_space(bytes_[at_])) ++at_;
  return at_end() || bytes_[at_] == '\n';
}

std::string_view TextCursor::take(std::size_t count) {
  if (count > bytes_left()) fail("it ends too early");
  at_ += count;
  return std::string_view(bytes_).substr(at_ - count, count);
}

std::size_t TextCursor::count_of(std::size_t least_bytes_each) {
  const auto count = number<std::uint64_t>();
  // The last thing may lack the white space behind it.
  if (least_bytes_each > 0 && count > (bytes_left() + 1) / least_bytes_each) fail("it ends too early");
  return count;
}

void TextCursor::fail(const std::string& why) const {
  // What has just been read may have been a whole line with its end.
  const std::size_t read = at_ > 0 ? at_ - 1 : 0;
  const auto lines = std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(read), '\n');
  throw_damaged(path_, "line " + number_text(lines + 1) + ": " + why);
}

void TextCursor::fail_at_number(std::string_view text) const {
  fail(text.empty() ? "it ends too early" : in_quotes(text.substr(0, kShown)) + " stands where a number should");
}

std::string in_small_letters(std::string_view text) {
  std::string changed(text);
  for (char& c : changed) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return changed;
}

std::string in_capitals(std::string_view text) {
  std::string changed(text);
  for (char& c : changed) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return changed;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace anatomesh
