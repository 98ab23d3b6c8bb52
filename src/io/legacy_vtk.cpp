// After "VTK File Formats" (the VTK User's Guide), the part on simple legacy formats.
#include "io/legacy_vtk.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "io/number_text.h"
#include "io/output_file.h"
#include "io/text_cursor.h"

namespace anatomesh {
namespace {

struct TypeName {
  std::string_view name;
  NumberType type;
};

/// The format's words for types; vtkIdType is stored in 32 bits.
constexpr std::array<TypeName, 22> kTypeNames = {{{"char", NumberType::i8},
                                                  {"unsigned_char", NumberType::u8},
                                                  {"short", NumberType::i16},
                                                  {"unsigned_short", NumberType::u16},
                                                  {"int", NumberType::i32},
                                                  {"unsigned_int", NumberType::u32},
                                                  {"long", NumberType::i64},
                                                  {"unsigned_long", NumberType::u64},
                                                  {"vtktypeint64", NumberType::i64},
                                                  {"vtktypeuint64", NumberType::u64},
                                                  {"long_long", NumberType::i64},
                                                  {"vtkidtype", NumberType::i32},
                                                  {"vtktypeint8", NumberType::i8},
                                                  {"vtktypeuint8", NumberType::u8},
                                                  {"vtktypeint16", NumberType::i16},
                                                  {"vtktypeuint16", NumberType::u16},
                                                  {"vtktypeint32", NumberType::i32},
                                                  {"vtktypeuint32", NumberType::u32},
                                                  {"vtktypefloat32", NumberType::f32},
                                                  {"vtktypefloat64", NumberType::f64},
                                                  {"float", NumberType::f32},
                                                  {"double", NumberType::f64}}};

/// Reads one file from its start to its end.
class LegacyReader {
 public:
  explicit LegacyReader(const std::filesystem::path& path) : text_(path) {}

  CellArrays read() {
    read_start();
    for (std::string section = upper_word(); !section.empty(); section = upper_word()) read_section(section);
    return std::move(cells_);
  }

 private:
  using Section = void (LegacyReader::*)();

  std::string_view word() { return text_.word(); }
  std::string upper_word() { return in_capitals(text_.word()); }
  std::size_t count() { return text_.number<std::uint32_t>(); }

  NumberType number_type() { return number_type(in_small_letters(word())); }
  NumberType number_type(const std::string& name) {
    const auto found =
        std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& known) { return known.name == name; });
    if (found == kTypeNames.end()) text_.fail(in_quotes(name.substr(0, 40)) + " is no known type of numbers");
    return found->type;
  }

  // ---- arrays

  NumberArray array(NumberType type, std::size_t size) {
    NumberArray result{type, {}};
    // Before memory is reserved for it: a number takes its bytes, or at least a digit and a space.
    const std::size_t least_bytes = is_binary_ ? bytes_of(type) : 2;
    if (is_binary_) text_.line();
    if (size > (text_.bytes_left() + 1) / least_bytes) text_.fail("it ends too early");
    result.bytes.resize(size * bytes_of(type));
    is_binary_ ? take_binary(result) : take_ascii(result);
    return result;
  }

  /// Binary numbers are stored big end first.
  void take_binary(NumberArray& to) {
    const std::string_view stored = text_.take(to.bytes.size());
    std::ranges::copy(std::as_bytes(std::span(stored)), to.bytes.begin());
    reverse_bytes(to);
  }

  void take_ascii(NumberArray& to) {
    with_number_type(to.type, [&]<typename Value>(Value) {
      for (std::size_t n = 0; n < to.bytes.size() / sizeof(Value); ++n) {
        const auto value = text_.number<Value>();
        std::memcpy(to.bytes.data() + n * sizeof(Value), &value, sizeof(Value));
      }
    });
  }

  // ---- sections

  void read_start() {
    const std::string_view first = text_.line();
    constexpr std::string_view kStart = "# vtk DataFile Version ";
    if (first.substr(0, kStart.size()) != kStart) text_.fail("it does not begin with '# vtk DataFile Version'");
    is_version_5_ = first.size() > kStart.size() && first[kStart.size()] >= '5';
    text_.line();  // the title
    const std::string encoding = upper_word();
    if (encoding != "ASCII" && encoding != "BINARY") text_.fail("its third line is neither ASCII nor BINARY");
    is_binary_ = encoding == "BINARY";
    if (upper_word() != "DATASET" || upper_word() != "UNSTRUCTURED_GRID") {
      text_.fail("it holds no unstructured grid");
    }
  }

  void read_section(const std::string& name) {
    struct Named {
      std::string_view name;
      Section read;
    };
    static constexpr std::array<Named, 18> kSections = {{{"POINTS", &LegacyReader::points},
                                                         {"CELLS", &LegacyReader::cells},
                                                         {"CELL_TYPES", &LegacyReader::cell_types},
                                                         {"CELL_DATA", &LegacyReader::cell_data},
                                                         {"POINT_DATA", &LegacyReader::point_data},
                                                         {"FIELD", &LegacyReader::field},
                                                         {"METADATA", &LegacyReader::metadata},
                                                         {"SCALARS", &LegacyReader::scalars},
                                                         {"LOOKUP_TABLE", &LegacyReader::lookup_table},
                                                         {"COLOR_SCALARS", &LegacyReader::color_scalars},
                                                         {"VECTORS", &LegacyReader::attribute<3>},
                                                         {"NORMALS", &LegacyReader::attribute<3>},
                                                         {"TENSORS", &LegacyReader::attribute<9>},
                                                         {"TENSORS6", &LegacyReader::attribute<6>},
                                                         {"GLOBAL_IDS", &LegacyReader::attribute<1>},
                                                         {"PEDIGREE_IDS", &LegacyReader::attribute<1>},
                                                         {"EDGE_FLAGS", &LegacyReader::attribute<1>},
                                                         {"TEXTURE_COORDINATES", &LegacyReader::texture}}};
    const auto found =
        std::find_if(kSections.begin(), kSections.end(), [&](const Named& section) { return section.name == name; });
    if (found == kSections.end()) text_.fail(in_quotes(name.substr(0, 40)) + " is no known section");
    (this->*found->read)();
  }

  void points() {
    const std::size_t point_count = count();
    cells_.points_mm = points_of(array(number_type(), 3 * point_count));
  }

  void cells() {
    const std::size_t first = count(), second = count();
    if (is_version_5_) {
      if (upper_word() != "OFFSETS") text_.fail("its cells have no offsets");
      cells_.offsets = integers_of(array(number_type(), first));
      if (upper_word() != "CONNECTIVITY") text_.fail("its cells have no connectivity");
      cells_.corners = integers_of(array(number_type(), second));
      return;
    }
    const std::vector<std::int64_t> list = integers_of(array(NumberType::i32, second));
    cells_.offsets = {0};
    for (std::size_t at = 0; at < list.size();) {
      const std::int64_t corners = list[at++];
      if (corners < 0 || static_cast<std::size_t>(corners) > list.size() - at) {
        text_.fail("a cell has " + number_text(corners) + " corners");
      }
      const auto begin = list.begin() + static_cast<std::ptrdiff_t>(at);
      cells_.corners.insert(cells_.corners.end(), begin, begin + corners);
      cells_.offsets.push_back(static_cast<std::int64_t>(cells_.corners.size()));
      at += static_cast<std::size_t>(corners);
    }
    if (cells_.offsets.size() != first + 1) text_.fail("its cells are not as many as it declares");
  }

  void cell_types() { cells_.types = integers_of(array(NumberType::i32, count())); }

  void cell_data() { begin_data(true); }
  void point_data() { begin_data(false); }

  void begin_data(bool of_cells) {
    data_size_ = count();
    is_cell_data_ = of_cells;
  }

  void keep(std::string_view name, std::size_t components, NumberArray values) {
    if (name == kNameArrays.values)
      cells_.label_values = std::move(values);
    else if (name == kNameArrays.names)
      cells_.label_names = texts_of(values);
    else if (name == kNameArrays.colours)
      cells_.label_colours = std::move(values);
    else if (is_cell_data_ && components == 1)
      cells_.arrays.push_back({decoded(name), std::move(values)});
  }

  void scalars() {
    const std::string name(word());
    const NumberType type = number_type();
    const std::string_view rest = text_.line();
    const bool has_components = rest.find_first_of("123456789") != std::string_view::npos;
    const auto components = has_components ? static_cast<std::size_t>(rest[rest.find_first_of("123456789")] - '0') : 1;
    if (upper_word() != "LOOKUP_TABLE" || word().empty()) text_.fail("its scalars have no lookup table");
    keep(name, components, array(type, components * data_size_));
  }

  void lookup_table() {
    word();
    array(is_binary_ ? NumberType::u8 : NumberType::f32, 4 * count());
  }

  void color_scalars() {
    word();
    array(is_binary_ ? NumberType::u8 : NumberType::f32, count() * data_size_);
  }

  template <std::size_t components>
  void attribute() {
    word();
    array(number_type(), components * data_size_);
  }

  void texture() {
    word();
    const std::size_t dimensions = count();
    array(number_type(), dimensions * data_size_);
  }

  void field() {
    word();
    for (std::size_t left = count(); left > 0; --left) {
      std::string name(word());
      while (in_capitals(name) == "METADATA") {
        metadata();
        name = word();
      }
      const std::size_t components = count(), tuples = count();
      const std::string type = in_small_letters(word());
      if (type == "string") {
        keep_strings(name, strings(components * tuples));
      } else {
        keep(name, components, array(number_type(type), components * tuples));
      }
    }
  }

  std::vector<std::string> strings(std::size_t size) {
    text_.line();
    if (size > text_.bytes_left()) text_.fail("it ends too early");
    std::vector<std::string> result(size);
    for (std::string& text : result)
      text = is_binary_ ? std::string(text_.take(binary_length())) : decoded(text_.line());
    return result;
  }

  /// The first two bits say in how many bytes, big end first, the length of a string is stored.
  std::size_t binary_length() {
    const auto byte = [&] { return static_cast<std::size_t>(static_cast<unsigned char>(text_.take(1)[0])); };
    const std::size_t first = byte(), more = std::size_t{8} >> (first >> 6u);
    std::size_t length = first & 0x3Fu;
    for (std::size_t n = 1; n < more; ++n) length = length << 8u | byte();
    return length;
  }

  void keep_strings(std::string_view name, std::vector<std::string> values) {
    if (name == kNameArrays.names) cells_.label_names = std::move(values);
  }

  /// Names and ranges of components, up to an empty line.
  void metadata() {
    text_.line();
    while (!text_.at_end() && !text_.line().empty()) continue;
  }

  /// Names have spaces and the like as %20.
  static std::string decoded(std::string_view name) {
    std::string result;
    for (std::size_t n = 0; n < name.size(); ++n) {
      unsigned code = 0;
      const bool is_code =
          name[n] == '%' && n + 2 < name.size() &&
          std::from_chars(name.data() + n + 1, name.data() + n + 3, code, 16).ptr == name.data() + n + 3;
      result += is_code ? static_cast<char>(code) : name[n];
      if (is_code) n += 2;
    }
    return result;
  }

  TextCursor text_;
  bool is_binary_ = false;
  bool is_version_5_ = false;
  bool is_cell_data_ = false;
  std::size_t data_size_ = 0;
  CellArrays cells_;
};

}  // namespace

CellArrays legacy_vtk_cells(const std::filesystem::path& path) { return LegacyReader(path).read(); }

}  // namespace anatomesh
