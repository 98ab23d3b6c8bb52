// After "VTK XML Formats" of VTK's documentation. The appended block is cut off before the rest is parsed: raw bytes
// are no XML.
#include "io/vtk_xml_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <utility>

#include "anatomesh/errors.h"
#include "io/base64.h"
#include "io/cell_arrays.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/text_cursor.h"

namespace anatomesh {
namespace {

constexpr std::string_view kEnd = "</VTKFile>";

struct TypeName {
  std::string_view name;
  NumberType type;
};

/// Strings are stored as their bytes, each with a zero behind it.
constexpr std::array<TypeName, 11> kTypeNames = {{{"UInt8", NumberType::u8},
                                                  {"Int8", NumberType::i8},
                                                  {"UInt16", NumberType::u16},
                                                  {"Int16", NumberType::i16},
                                                  {"UInt32", NumberType::u32},
                                                  {"Int32", NumberType::i32},
                                                  {"UInt64", NumberType::u64},
                                                  {"Int64", NumberType::i64},
                                                  {"Float32", NumberType::f32},
                                                  {"Float64", NumberType::f64},
                                                  {"String", NumberType::i8}}};

bool is_within(std::string_view text, std::initializer_list<std::string_view> choices) {
  return std::ranges::find(choices, text) != choices.end();
}

void collect_offsets(pugi::xml_node from, std::vector<std::size_t>& offsets) {
  for (const pugi::xpath_node& array : from.select_nodes("//*[@offset]")) {
    offsets.push_back(array.node().attribute("offset").as_ullong());
  }
  std::ranges::sort(offsets);
}

/// Numbers of the type as text, in bytes.
std::vector<std::byte> parsed(const char* text, NumberType type, const ArrayPlace& place) {
  std::vector<std::byte> bytes;
  with_number_type(type, [&]<typename Value>(Value value) {
    const char* const end = text + std::strlen(text);
    for (const char* at = text;;) {
      at = std::find_if_not(at, end, [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); });
      if (at == end) return;
      if (*at == '+') ++at;
      const auto [next, error] = std::from_chars(at, end, value);
      if (error != std::errc()) place.fail("holds something that is no number of its type");
      at = next;
      const std::size_t size = bytes.size();
      bytes.resize(size + sizeof(Value));
      std::memcpy(bytes.data() + size, &value, sizeof(Value));
    }
  });
  return bytes;
}

}  // namespace

VtkXmlFile::VtkXmlFile(const std::filesystem::path& path, const char* type) : path_(path), bytes_(bytes_of_file(path)) {
  cut_appended_off();
  const pugi::xml_parse_result result =
      document_.load_buffer_inplace(head_.data(), head_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result) {
    throw_damaged(path_, "it is no unstructured grid in VTK's XML format: " + std::string(result.description()) +
                             " at byte " + number_text(result.offset));
  }
  read_root(type);
}

void VtkXmlFile::cut_appended_off() {
  const std::size_t begin = bytes_.find("<AppendedData");
  if (begin == std::string::npos) {
    head_ = std::move(bytes_);
    bytes_.clear();
    return;
  }
  const std::size_t tag_end = bytes_.find('>', begin);
  const std::size_t mark = bytes_.find('_', std::min(tag_end, bytes_.size()));
  if (tag_end == std::string::npos || mark == std::string::npos) throw_damaged(path_, "its appended data are missing");
  if (!trimmed(bytes_).ends_with(kEnd)) throw_damaged(path_, "it does not end with </VTKFile>");
  head_.append(bytes_, 0, tag_end + 1).append("</AppendedData>").append(kEnd);
  appended_ = std::string_view(bytes_).substr(mark + 1);
  appended_.remove_suffix(appended_.size() - appended_.rfind("</"));  // of </VTKFile>
  appended_ = appended_.substr(0, appended_.rfind("</"));             // of </AppendedData>
}

void VtkXmlFile::read_root(const char* type) {
  const pugi::xml_node root = document_.child("VTKFile");
  data_set_ = root.child(type);
  if (std::string_view(root.attribute("type").value()) != type || !data_set_) {
    throw_damaged(path_, "it is no unstructured grid in VTK's XML format");
  }
  const std::string_view compressor = root.attribute("compressor").value();
  if (!is_within(compressor, {"", "vtkZLibDataCompressor"})) {
    throw InvalidInput(in_quotes(path_) + " is compressed with '" + std::string(compressor) +
                       "'; vtkZLibDataCompressor and files that are not compressed can be read");
  }
  const std::string_view order = root.attribute("byte_order").as_string("LittleEndian");
  const std::string_view size_type = root.attribute("header_type").as_string("UInt32");
  if (!is_within(order, {"LittleEndian", "BigEndian"}) || !is_within(size_type, {"UInt32", "UInt64"})) {
    throw_damaged(path_, "it is in the byte order '" + std::string(order) + "' with headers of '" +
                             std::string(size_type) + "'; LittleEndian or BigEndian and UInt32 or UInt64 are known");
  }
  storage_ = {order == "BigEndian" ? std::endian::big : std::endian::little, size_type == "UInt64" ? 8U : 4U,
              !compressor.empty()};
  is_appended_base64_ = std::string_view(root.child("AppendedData").attribute("encoding").value()) != "raw";
  if (is_appended_base64_) collect_offsets(root, appended_offsets_);
}

/// Where base64 text ends is not said anywhere but by the beginning of the next.
std::string_view VtkXmlFile::appended_from(std::size_t offset) const {
  const auto next = std::ranges::upper_bound(appended_offsets_, offset);
  const std::size_t end = next == appended_offsets_.end() ? appended_.size() : std::min(*next, appended_.size());
  return appended_.substr(offset, end - offset);
}

std::vector<std::byte> VtkXmlFile::binary(pugi::xml_node array, const ArrayPlace& place) const {
  const bool is_appended = array.attribute("offset");
  std::string_view stored = array.text().get();
  if (is_appended) {
    const std::size_t offset = array.attribute("offset").as_ullong();
    if (offset > appended_.size()) place.fail("begins beyond the end of the appended data");
    stored = appended_from(offset);
    if (!is_appended_base64_) return data_of(stored, storage_, place);
  }
  const auto decoded = base64_decoded(stored);
  if (!decoded) place.fail("is no base64");
  return data_of(*decoded, storage_, place);
}

std::vector<std::byte> VtkXmlFile::bytes_of(pugi::xml_node array, NumberType type) const {
  const ArrayPlace place{path_, name_of(array)};
  const std::string_view format = array.attribute("format").as_string("ascii");
  if (!is_within(format, {"ascii", "binary", "appended"})) place.fail("has no known format");
  return format == "ascii" ? parsed(array.text().get(), type, place) : binary(array, place);
}

NumberArray VtkXmlFile::numbers(pugi::xml_node array) const {
  const ArrayPlace place{path_, name_of(array)};
  const auto type = number_type_of(array);
  if (!type) place.fail("has no known type of numbers");
  NumberArray result{*type, bytes_of(array, *type)};
  if (result.bytes.size() % anatomesh::bytes_of(*type) != 0) place.fail("ends within a number");
  const bool is_text = std::string_view(array.attribute("format").as_string("ascii")) == "ascii";
  if (!is_text && storage_.order != std::endian::native) reverse_bytes(result);
  return result;
}

std::optional<NumberType> number_type_of(pugi::xml_node array) {
  const auto found = std::ranges::find(kTypeNames, std::string_view(array.attribute("type").value()), &TypeName::name);
  return found == kTypeNames.end() ? std::nullopt : std::optional(found->type);
}

std::string_view name_of(pugi::xml_node array) { return array.attribute("Name").value(); }

}  // namespace anatomesh
