// After "VTK File Formats" (the VTK User's Guide), the part on simple legacy formats.
#include "io/legacy_vtk.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "io/number_text.h"
#include "io/output_file.h"

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

std::string in_letters(std::string_view text, int (*change)(int)) {
  std::string changed(text);
  for (char& c : changed) c = static_cast<char>(change(static_cast<unsigned char>(c)));
  return changed;
}

/// Reads one file from its start to its end.
class LegacyReader {
 public:
  LegacyReader(const std::filesystem::path& path, std::string bytes) : path_(path), bytes_(std::move(bytes)) {}

  CellArrays read() {
    read_start();
    for (std::string section = upper_word(); !section.empty(); section = upper_word()) read_section(section);
    return std::move(cells_);
  }

 private:
  using Section = void (LegacyReader::*)();

  // ---- the text: words, lines and numbers

  bool at_space() const { return std::isspace(static_cast<unsigned char>(bytes_[at_])) != 0; }

  /// The next word; empty at the end of the file.
  std::string_view word() {
    while (at_ < bytes_.size() && at_space()) ++at_;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !at_space()) ++at_;
    return std::string_view(bytes_).substr(begin, at_ - begin);
  }

  std::string upper_word() { return in_letters(word(), &std::toupper); }

  /// The rest of the present line.
  std::string_view line() {
    const std::size_t begin = std::min(at_, bytes_.size());
    const std::size_t end = std::min(bytes_.find('\n', begin), bytes_.size());
    at_ = std::min(end + 1, bytes_.size());
    return std::string_view(bytes_).substr(begin, end - begin);
  }

  template <typename Number>
  Number number() {
    const std::string_view text = word();
    Number value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      throw_damaged(
          path_, text.empty() ? "it ends too early" : in_quotes(text.substr(0, 40)) + " stands where a number should");
    }
    return value;
  }

  std::size_t count() { return number<std::uint32_t>(); }

  NumberType number_type() {
    const std::string name = in_letters(word(), &std::tolower);
    const auto found =
        std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& known) { return known.name == name; });
    if (found == kTypeNames.end()) throw_damaged(path_, in_quotes(name.substr(0, 40)) + " is no known type of numbers");
    return found->type;
  }

  // ---- arrays

  NumberArray array(NumberType type, std::size_t size) {
    NumberArray result{type, {}};
    // Before memory is reserved for it: a number takes its bytes, or at least a digit and a space.
    const std::size_t least_bytes = is_binary_ ? bytes_of(type) : 2;
    if (is_binary_) line();
    if (size > (bytes_.size() - at_ + 1) / least_bytes) throw_damaged(path_, "it ends too early");
    result.bytes.resize(size * bytes_of(type));
    is_binary_ ? take_binary(result) : take_ascii(result);
    return result;
  }

  /// Binary numbers are stored big end first.
  void take_binary(NumberArray& to) {
    const std::size_t each = bytes_of(to.type);
    if (to.bytes.size() > bytes_.size() - at_) throw_damaged(path_, "it ends too early");
    std::memcpy(to.bytes.data(), bytes_.data() + at_, to.bytes.size());
    at_ += to.bytes.size();
    for (auto value = to.bytes.begin(); value != to.bytes.end(); value += static_cast<std::ptrdiff_t>(each)) {
      std::reverse(value, value + static_cast<std::ptrdiff_t>(each));
    }
  }

  void take_ascii(NumberArray& to) {
    for_type(to.type, [&]<typename Value>(Value) {
      for (std::size_t n = 0; n < to.bytes.size() / sizeof(Value); ++n) {
        const Value value = number<Value>();
        std::memcpy(to.bytes.data() + n * sizeof(Value), &value, sizeof(Value));
      }
    });
  }

  std::vector<std::int64_t> integers(const NumberArray& from) const {
    std::vector<std::int64_t> result(from.size());
    for_type(from.type, [&]<typename Value>(Value value) {
      for (std::size_t n = 0; n < result.size(); ++n) {
        std::memcpy(&value, from.bytes.data() + n * sizeof(Value), sizeof(Value));
        result[n] = in_int64(value);
      }
    });
    return result;
  }

  // ---- sections

  void read_start() {
    const std::string_view first = line();
    constexpr std::string_view kStart = "# vtk DataFile Version ";
    if (first.substr(0, kStart.size()) != kStart)
      throw_damaged(path_, "it does not begin with '# vtk DataFile Version'");
    is_version_5_ = first.size() > kStart.size() && first[kStart.size()] >= '5';
    line();  // the title
    const std::string encoding = upper_word();
    if (encoding != "ASCII" && encoding != "BINARY") throw_damaged(path_, "its third line is neither ASCII nor BINARY");
    is_binary_ = encoding == "BINARY";
    if (upper_word() != "DATASET" || upper_word() != "UNSTRUCTURED_GRID") {
      throw_damaged(path_, "it holds no unstructured grid");
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
    if (found == kSections.end()) throw_damaged(path_, in_quotes(name.substr(0, 40)) + " is no known section");
    (this->*found->read)();
  }

  void points() {
    const std::size_t point_count = count();
    const NumberArray coordinates = array(number_type(), 3 * point_count);
    cells_.points_mm.resize(point_count);
    for_type(coordinates.type, [&]<typename Value>(Value value) {
      for (std::size_t n = 0; n < 3 * point_count; ++n) {
        std::memcpy(&value, coordinates.bytes.data() + n * sizeof(Value), sizeof(Value));
        cells_.points_mm[n / 3][n % 3] = static_cast<double>(value);
      }
    });
  }

  void cells() {
    const std::size_t first = count(), second = count();
    if (is_version_5_) {
      if (upper_word() != "OFFSETS") throw_damaged(path_, "its cells have no offsets");
      cells_.offsets = integers(array(number_type(), first));
      if (upper_word() != "CONNECTIVITY") throw_damaged(path_, "its cells have no connectivity");
      cells_.corners = integers(array(number_type(), second));
      return;
    }
    const std::vector<std::int64_t> list = integers(array(NumberType::i32, second));
    cells_.offsets = {0};
    for (std::size_t at = 0; at < list.size();) {
      const std::int64_t corners = list[at++];
      if (corners < 0 || static_cast<std::size_t>(corners) > list.size() - at) {
        throw_damaged(path_, "a cell has " + number_text(corners) + " corners");
      }
      const auto begin = list.begin() + static_cast<std::ptrdiff_t>(at);
      cells_.corners.insert(cells_.corners.end(), begin, begin + corners);
      cells_.offsets.push_back(static_cast<std::int64_t>(cells_.corners.size()));
      at += static_cast<std::size_t>(corners);
    }
    if (cells_.offsets.size() != first + 1) throw_damaged(path_, "its cells are not as many as it declares");
  }

  void cell_types() { cells_.types = integers(array(NumberType::i32, count())); }

  void cell_data() { begin_data(true); }
  void point_data() { begin_data(false); }

  void begin_data(bool of_cells) {
    data_size_ = count();
    is_cell_data_ = of_cells;
  }

  void keep(std::string_view name, std::size_t components, NumberArray values) {
    if (is_cell_data_ && components == 1) cells_.arrays.push_back({decoded(name), std::move(values)});
  }

  void scalars() {
    const std::string name(word());
    const NumberType type = number_type();
    const std::string_view rest = line();
    const bool has_components = rest.find_first_of("123456789") != std::string_view::npos;
    const auto components = has_components ? static_cast<std::size_t>(rest[rest.find_first_of("123456789")] - '0') : 1;
    if (upper_word() != "LOOKUP_TABLE" || word().empty()) throw_damaged(path_, "its scalars have no lookup table");
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
      while (in_letters(name, &std::toupper) == "METADATA") {
        metadata();
        name = word();
      }
      const std::size_t components = count(), tuples = count();
      keep(name, components, array(number_type(), components * tuples));
    }
  }

  /// Names and ranges of components, up to an empty line.
  void metadata() {
    line();
    while (at_ < bytes_.size() && !line().empty()) continue;
  }

  // ---- conversions

  /// Calls with a value of the C++ type of the given number type.
  template <typename Call>
  static void for_type(NumberType type, Call&& call) {
    switch (type) {
      case NumberType::u8:
        return call(std::uint8_t{});
      case NumberType::i8:
        return call(std::int8_t{});
      case NumberType::u16:
        return call(std::uint16_t{});
      case NumberType::i16:
        return call(std::int16_t{});
      case NumberType::u32:
        return call(std::uint32_t{});
      case NumberType::i32:
        return call(std::int32_t{});
      case NumberType::u64:
        return call(std::uint64_t{});
      case NumberType::i64:
        return call(std::int64_t{});
      case NumberType::f32:
        return call(float{});
      case NumberType::f64:
        return call(double{});
    }
  }

  /// Ids and offsets; what does not fit becomes -1, which is out of range for all of them.
  template <typename Value>
  static std::int64_t in_int64(Value value) {
    constexpr std::int64_t kMost = std::int64_t{1} << 53;
    return value >= 0 && static_cast<double>(value) <= static_cast<double>(kMost) ? static_cast<std::int64_t>(value)
                                                                                  : -1;
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

  const std::filesystem::path& path_;
  std::string bytes_;
  std::size_t at_ = 0;
  bool is_binary_ = false;
  bool is_version_5_ = false;
  bool is_cell_data_ = false;
  std::size_t data_size_ = 0;
  CellArrays cells_;
};

}  // namespace

CellArrays read_legacy_vtk(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return LegacyReader(path, {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()}).read();
}

}  // namespace anatomesh
