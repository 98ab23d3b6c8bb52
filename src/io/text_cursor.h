// Reading a file from its start to its end: words, lines and numbers, with errors that say where.
#pragma once

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace anatomesh {

/// A place in the bytes of a file.
class TextCursor {
 public:
  /// Reads the whole file. Throws IoError.
  explicit TextCursor(std::filesystem::path path);
  /// Takes the bytes instead; the path is for messages.
  TextCursor(std::filesystem::path path, std::string bytes);

  const std::filesystem::path& path() const { return path_; }
  bool at_end() const { return at_ >= bytes_.size(); }
  std::size_t bytes_left() const { return bytes_.size() - at_; }

  /// The next word, up to white space; empty at the end of the file.
  std::string_view word();
  /// The rest of the present line, without its end ("\n" or "\r\n").
  std::string_view line();
  /// Whether nothing but white space is left in the present line.
  bool at_line_end();
  /// So many bytes as they are. Throws IoError where the file ends before.
  std::string_view take(std::size_t count);

  /// The next word as a number. Throws IoError.
  template <typename Number>
  Number number() {
    return number_from<Number>(word());
  }
  /// A number from a piece of the present text. Throws IoError.
  template <typename Number>
  Number number_from(std::string_view text) const {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) fail_at_number(text);
    return value;
  }

  /// A number of things that each take at least so many bytes in what is left of the file. Throws IoError, before
  /// anybody makes room for what cannot be there.
  std::size_t count_of(std::size_t least_bytes_each);

  /// Throws IoError: "FILE is truncated or damaged: line N: why".
  [[noreturn]] void fail(const std::string& why) const;

 private:
  [[noreturn]] void fail_at_number(std::string_view text) const;

  std::filesystem::path path_;
  std::string bytes_;
  std::size_t at_ = 0;
};

/// All of it. Throws IoError.
std::string bytes_of_file(const std::filesystem::path& path);

/// In small or capital letters (ASCII).
std::string in_small_letters(std::string_view text);
std::string in_capitals(std::string_view text);

/// Without white space at either end.
std::string_view trimmed(std::string_view text);

}  // namespace anatomesh
