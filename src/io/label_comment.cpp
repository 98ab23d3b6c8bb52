#include "io/label_comment.h"

#include <cctype>
#include <charconv>

#include "io/number_text.h"
#include "io/text_cursor.h"

namespace anatomesh {
namespace {

constexpr std::string_view kStart = "label ";
constexpr std::string_view kIs = " is ";

std::string in_one_line(std::string_view name) {
  std::string line(trimmed(name));
  for (char& c : line) {
    if (std::iscntrl(static_cast<unsigned char>(c))) c = ' ';
  }
  return line;
}

}  // namespace

std::vector<LabelComment> label_comments(const TetMesh& mesh, const std::map<Label, std::string>& sets) {
  std::vector<LabelComment> comments;
  for (const auto& [label, set] : sets) {
    const auto entry = mesh.names.find(label);
    comments.push_back({label, set, entry == mesh.names.end() ? "" : in_one_line(entry->second.name)});
  }
  return comments;
}

std::string text_of(const LabelComment& comment) {
  std::string text(kStart);
  text.append(number_text(comment.label)).append(kIs).append(comment.set);
  if (!comment.name.empty()) text.append(": ").append(comment.name);
  return text;
}

std::optional<LabelComment> label_comment_in(std::string_view text) {
  text = trimmed(text);
  if (!text.starts_with(kStart)) return std::nullopt;
  text.remove_prefix(kStart.size());
  LabelComment comment;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), comment.label);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (!text.starts_with(kIs)) return std::nullopt;
  text.remove_prefix(kIs.size());
  const std::size_t colon = text.find(": ");
  comment.set = trimmed(text.substr(0, colon));
  if (colon != std::string_view::npos) comment.name = trimmed(text.substr(colon + 2));
  return comment;
}

void add_name(const LabelComment& comment, LabelTable& names) {
  if (!comment.name.empty()) names[comment.label].name = comment.name;
}

}  // namespace anatomesh
