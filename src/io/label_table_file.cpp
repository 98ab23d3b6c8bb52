// After the formats' documents: Slicer's developer guide, "Colors" (slicer.readthedocs.io); the comments at the head of
// every label description of ITK-SNAP (itksnap.org); FreeSurfer's wiki, "LabelsClutsAnnotationFiles"
// (surfer.nmr.mgh.harvard.edu); the *_dseg.tsv of BIDS (bids-specification.readthedocs.io); RFC 4180 for CSV.
#include "io/label_table_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/label_values.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/utf8.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

/// A table of every label that 32 bits can number would be larger, but nobody names those.
constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 24;

/// A piece of a line, without its quotes.
struct Field {
  std::string text;
  bool quoted = false;
};
using Fields = std::vector<Field>;

constexpr std::size_t kNone = std::string_view::npos;

/// How the lines of a file are made: what separates their fields, and which of them holds what.
struct Layout {
  char separator = ' ';  ///< a space stands for any white space
  std::size_t label = 0, name = 1;
  std::array<std::size_t, 3> colour = {2, 3, 4};  ///< kNone: there is none
  std::size_t most_fields = 6;
  const char* rule = "";  ///< of a line, for messages
};

constexpr Layout kSnap = {' ',       0, 7,
                          {1, 2, 3}, 8, "a line is: index red green blue opacity visibility mesh-visibility \"name\""};
constexpr Layout kColourTable = {
    ' ', 0, 1, {2, 3, 4}, 6, "a line is: index name red green blue alpha, where the name has _ for spaces or quotes"};
constexpr Layout kList = {',', 0, 1, {2, 3, 4}, 6, "a line is: label,name or label,name,red,green,blue"};

/// Titles of columns in small letters, the best first.
constexpr std::array kLabelTitles = {"labelvalue", "label_value", "index", "idx", "id", "value", "number", "label"};
constexpr std::array kNameTitles = {"name", "labelname", "label_name", "structure", "region", "tissue", "label"};
constexpr std::array<std::array<const char*, 3>, 3> kColourTitles = {
    {{"r", "red", "color_r"}, {"g", "green", "color_g"}, {"b", "blue", "color_b"}}};

/// A line of a table.
struct Line {
  const fs::path& path;
  std::size_t number;  ///< from 1
  std::string_view text;

  /// Throws InvalidInput: "line N of FILE WHY; RIGHT".
  [[noreturn]] void fail(const std::string& why, std::string_view right) const {
    throw InvalidInput("line " + number_text(number) + " of " + in_quotes(path) + " " + why + "; " +
                       std::string(right));
  }
};

constexpr std::size_t kShown = 40;  // bytes of a wrong field in a message

std::string shown(std::string_view text) { return std::string(1, '\'').append(text.substr(0, kShown)).append(1, '\''); }

bool is_space(char c) { return c == ' ' || c == '\t'; }

/// Takes a field in quotation marks off the text, two of which within stand for one.
Field quoted_field(const Line& line, std::string_view& text) {
  Field field = {"", true};
  for (text.remove_prefix(1);; text.remove_prefix(1)) {
    if (text.empty()) line.fail("has a quotation mark that is not closed", "quotation marks come in pairs");
    if (text.front() != '"') {
      field.text += text.front();
    } else if (text.substr(0, 2) == "\"\"") {
      field.text += '"';
      text.remove_prefix(1);
    } else {
      text.remove_prefix(1);
      return field;
    }
  }
}

/// Words, up to a comment behind them.
Fields words_of(const Line& line) {
  Fields fields;
  for (std::string_view rest = trimmed(line.text); !rest.empty(); rest = trimmed(rest)) {
    if (rest.front() == '#' && fields.size() > 1) break;
    if (rest.front() == '"') {
      fields.push_back(quoted_field(line, rest));
      continue;
    }
    const auto end = static_cast<std::size_t>(std::ranges::find_if(rest, is_space) - rest.begin());
    fields.push_back({std::string(rest.substr(0, end))});
    rest.remove_prefix(end);
  }
  return fields;
}

Fields separated_fields(const Line& line, char separator) {
  Fields fields;
  std::string_view rest = line.text;
  for (bool more = true; more;) {
    while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
    Field field;
    if (!rest.empty() && rest.front() == '"') field = quoted_field(line, rest);
    const std::size_t end = std::min(rest.find(separator), rest.size());
    const std::string_view bare = trimmed(rest.substr(0, end));
    if (field.quoted && !bare.empty()) line.fail("has " + shown(bare) + " behind a quotation mark", kList.rule);
    if (!field.quoted) field.text = bare;
    fields.push_back(std::move(field));
    more = end < rest.size();
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  while (fields.size() > 2 && fields.back().text.empty()) fields.pop_back();  // as spreadsheets leave them
  return fields;
}

Fields fields_of(const Line& line, const Layout& layout) {
  return layout.separator == ' ' ? words_of(line) : separated_fields(line, layout.separator);
}

/// What stands behind the first number of a line, or first at all between its titles. Several tabs in a row are there
/// to align the columns.
char separator_of(std::string_view text) {
  if (text.find("\t\t") != kNone) return ' ';
  constexpr std::string_view kDigits = "0123456789", kSeparators = ",;\t";
  const std::size_t at = kDigits.find(text.front()) != kNone
                             ? text.find_first_not_of(' ', text.find_first_not_of(kDigits))
                             : text.find_first_of(kSeparators);
  return at != kNone && kSeparators.find(text[at]) != kNone ? text[at] : ' ';
}

bool is_snap(const Fields& words) {
  return words.size() == kSnap.most_fields && words.back().quoted && !words[kSnap.colour[0]].quoted;
}

/// The column that has one of the titles, and is not the other.
template <typename Titles>
std::size_t column_of(const Titles& titles, const Fields& fields, std::size_t other = kNone) {
  for (const char* title : titles) {
    for (std::size_t n = 0; n < fields.size(); ++n) {
      if (n != other && in_small_letters(fields[n].text) == title) return n;
    }
  }
  return kNone;
}

/// The layout that a line of titles gives; nothing where it is no such line.
std::optional<Layout> titled_layout(const Fields& fields, char separator) {
  Layout layout = kList;
  layout.separator = separator;
  layout.most_fields = kNone;
  layout.label = column_of(kLabelTitles, fields);
  layout.name = column_of(kNameTitles, fields, layout.label);
  for (std::size_t c = 0; c < 3; ++c) layout.colour[c] = column_of(kColourTitles[c], fields);
  if (layout.label == kNone || layout.name == kNone) return std::nullopt;
  if (std::ranges::find(layout.colour, kNone) != layout.colour.end()) layout.colour.fill(kNone);
  return layout;
}

Label label_in(const Line& line, const Layout& layout, std::string_view text) {
  Label label = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), label);
  if (!text.empty() && error == std::errc() && end == text.data() + text.size()) return label;
  line.fail("has the label " + shown(text), std::string(kLabelRule) + ", and " + layout.rule);
}

std::uint8_t colour_in(const Line& line, std::string_view text) {
  constexpr double kMost = 255;
  double value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && value >= 0 && value <= kMost) {
    return static_cast<std::uint8_t>(std::lround(value));
  }
  line.fail("has " + shown(text) + " for a part of a colour", "red, green and blue are numbers from 0 to 255");
}

/// Nothing where the line ends before its colour, or has it empty.
std::optional<Colour> colour_of(const Line& line, const Layout& layout, const Fields& fields) {
  const auto at = [&](std::size_t part) -> std::string_view {
    const std::size_t n = layout.colour[part];
    return n < fields.size() ? std::string_view(fields[n].text) : std::string_view();
  };
  if (at(0).empty() && at(1).empty() && at(2).empty()) return std::nullopt;
  return Colour{colour_in(line, at(0)), colour_in(line, at(1)), colour_in(line, at(2))};
}

std::pair<Label, LabelEntry> entry_of(const Line& line, const Layout& layout) {
  const Fields fields = fields_of(line, layout);
  const Label label = label_in(line, layout, layout.label < fields.size() ? fields[layout.label].text : "");
  if (fields.size() <= layout.name) line.fail("has no name", layout.rule);
  const bool is_short = layout.most_fields != kNone && fields.size() > layout.name + 1 && fields.size() < 5;
  if (is_short || fields.size() > layout.most_fields) {
    line.fail("has " + number_text(fields.size()) + " fields", layout.rule);
  }
  return {label, {fields[layout.name].text, colour_of(line, layout, fields)}};
}

/// A table on its way: the layout comes from the first line that is no comment.
class TableReader {
 public:
  explicit TableReader(const fs::path& path) : path_(path) {}

  void take(std::string_view text) {
    const Line line = {path_, ++lines_, text};
    if (!is_one_line_of_utf8(text)) line.fail("is no text", "a label table is text in UTF-8");
    const std::string_view content = trimmed(text);
    if (content.starts_with("# Color table file")) underscores_are_spaces_ = true;
    if (content.empty() || content.front() == '#') return;
    if (!layout_ && begin(line)) return;
    auto [label, entry] = entry_of(line, *layout_);
    if (underscores_are_spaces_) std::ranges::replace(entry.name, '_', ' ');
    keep(line, label, std::move(entry));
  }

  LabelTable table() const {
    if (table_.empty()) throw InvalidInput(in_quotes(path_) + " names no label; " + kColourTable.rule);
    return table_;
  }

 private:
  /// Finds the layout; whether the line is one of titles, with no label in it.
  bool begin(const Line& line) {
    const char separator = separator_of(trimmed(line.text));
    if (separator == ' ') {
      layout_ = is_snap(words_of(line)) ? kSnap : kColourTable;
    } else if (const auto titled = titled_layout(separated_fields(line, separator), separator)) {
      layout_ = titled;
      return true;
    } else {
      layout_ = kList;
      layout_->separator = separator;
    }
    return false;
  }

  void keep(const Line& line, Label label, LabelEntry entry) {
    const auto [at, is_new] = first_lines_.emplace(label, line.number);
    if (!is_new && table_.at(label) != entry) {
      line.fail("names label " + number_text(label) + " again, otherwise than line " + number_text(at->second),
                "one name a label is needed");
    }
    table_.emplace(label, std::move(entry));
  }

  const fs::path& path_;
  std::size_t lines_ = 0;
  std::optional<Layout> layout_;
  bool underscores_are_spaces_ = false;  ///< Slicer writes them so
  LabelTable table_;
  std::map<Label, std::size_t> first_lines_;
};

}  // namespace

LabelTable label_table_from(TextCursor text) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  const fs::path path = text.path();
  TableReader reader(path);
  for (bool is_first = true; !text.at_end(); is_first = false) {
    std::string_view line = text.line();
    if (is_first && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
    reader.take(line);
  }
  return reader.table();
}

LabelTable read_label_table(const fs::path& path) {
  require_readable(path);
  if (!fs::is_regular_file(path)) throw InvalidInput(in_quotes(path) + " is a folder; name a label table");
  if (fs::file_size(path) > kMostBytes) {
    throw InvalidInput(in_quotes(path) + " has " + number_text(fs::file_size(path)) +
                       " bytes; a label table has up to " + number_text(kMostBytes));
  }
  return label_table_from(TextCursor(path));
}

}  // namespace anatomesh
