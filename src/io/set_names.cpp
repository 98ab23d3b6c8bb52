#include "io/set_names.h"

#include <cctype>
#include <set>
#include <string_view>
#include <utility>

#include "io/number_text.h"
#include "io/text_cursor.h"

namespace anatomesh {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Never cuts a UTF-8 character.
void shorten(std::string& name, std::size_t most_bytes) {
  if (name.size() <= most_bytes) return;
  std::size_t end = most_bytes;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
  name.resize(end);
}

std::string allowed(std::string_view name, const NameRule& rule) {
  const std::string_view shown = trimmed(name);
  std::string result;
  if (rule.identifier && !shown.empty() && !is_letter(shown.front())) result = "label_";
  for (const char c : shown) {
    const bool fits = rule.identifier ? is_letter(c) || is_digit(c)
                                      : c != '"' && c != '\'' && !std::iscntrl(static_cast<unsigned char>(c));
    result += fits ? c : '_';
  }
  return result;
}

// Names that more than one label has get the label behind them.
void tell_apart(std::map<Label, std::string>& names, const NameRule& rule) {
  const auto key = [&](const std::string& name) { return rule.tells_case_apart ? name : in_small_letters(name); };
  std::map<std::string, int> uses;
  for (const auto& [label, name] : names) ++uses[key(name)];
  std::set<std::string> taken;
  for (const auto& [name, count] : uses) {
    if (count == 1) taken.insert(name);
  }
  for (auto& [label, name] : names) {
    if (uses[key(name)] == 1) continue;
    std::string tail(1, '_');
    tail += number_text(label);
    for (;; tail += '_') {
      std::string longer = name;
      shorten(longer, rule.most_bytes - tail.size());
      longer += tail;
      if (!taken.insert(key(longer)).second) continue;
      name = std::move(longer);
      break;
    }
  }
}

}  // namespace

std::string default_set_name(Label label) { return std::string("label_").append(number_text(label)); }

std::map<Label, std::string> set_names(const TetMesh& mesh, const NameRule& rule) {
  std::map<Label, std::string> names;
  for (const Label label : std::set<Label>(mesh.labels.begin(), mesh.labels.end())) {
    const auto entry = mesh.names.find(label);
    std::string name = entry == mesh.names.end() ? "" : allowed(entry->second.name, rule);
    if (name.empty()) name = default_set_name(label);
    shorten(name, rule.most_bytes);
    names[label] = name;
  }
  tell_apart(names, rule);
  return names;
}

}  // namespace anatomesh
