#include "apps/text_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace anatomesh::apps {

std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, 1, ',');
  return text;
}

std::string fixed(double number, int decimals) {
  return std::isnan(number) ? "-" : fmt::format("{:.{}f}", number, decimals);
}

std::string byte_size(std::uint64_t bytes) {
  constexpr std::array units = {"kB", "MB", "GB", "TB"};
  if (bytes < 1000) return fmt::format("{} bytes", bytes);
  double size = static_cast<double>(bytes) / 1000;
  std::size_t unit = 0;
  for (; size >= 999.95 && unit + 1 < units.size(); ++unit) size /= 1000;
  return fmt::format("{:.1f} {}", size, units[unit]);
}

std::string field(std::string_view name, std::string_view value) { return fmt::format("{:<18}{}\n", name, value); }

std::size_t character_count(std::string_view text) {
  const auto begins_one = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_one));
}

std::string shortened_to(std::size_t most_characters, std::string_view text) {
  if (character_count(text) <= most_characters) return std::string(text);
  constexpr std::string_view kCut = "...";
  std::size_t end = text.size();
  while (end > 0 && character_count(text.substr(0, end)) > most_characters - kCut.size()) --end;
  return std::string(text.substr(0, end)).append(kCut);
}

std::string columns(const std::vector<std::string>& titles, const std::vector<std::vector<std::string>>& rows) {
  std::string text;
  std::vector<std::size_t> widths;
  for (const std::string& title : titles) widths.push_back(title.size());
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], character_count(row[c]));
  const auto add_row = [&](const std::vector<std::string>& row) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - character_count(row[c]), ' ');
      const bool is_name = titles[c] == kNameTitle;
      text.append(c == 0 ? "" : "  ").append(is_name ? "" : space).append(row[c]);
      if (is_name && c + 1 < row.size()) text += space;
    }
    text += '\n';
  };
  add_row(titles);
  for (const auto& row : rows) add_row(row);
  return text;
}

}  // namespace anatomesh::apps
