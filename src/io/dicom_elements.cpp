// After DICOM PS3.5, 7 "The Data Set", and PS3.10, 7.1 "DICOM File Meta Information" (dicom.nema.org).
#include "io/dicom_elements.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "anatomesh/errors.h"
#include "io/cell_arrays.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;
constexpr DicomTag kItem = 0xFFFEE000, kItemEnd = 0xFFFEE00D, kSequenceEnd = 0xFFFEE0DD;
constexpr DicomTag kTransferSyntax = 0x00020010, kPixelData = 0x7FE00010;
constexpr std::string_view kImplicit = "1.2.840.10008.1.2", kExplicit = "1.2.840.10008.1.2.1";
constexpr std::size_t kBeginning = 132;  // bytes of the preamble and "DICM"

/// Types of values whose length takes four bytes.
constexpr std::array<std::string_view, 13> kLongTypes = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                         "SV", "UC", "UN", "UR", "UT", "UV"};

/// How an element begins.
struct Head {
  DicomTag tag = 0;
  bool may_be_sequence = false;
  bool has_typed_items = true;
  std::uint32_t length = 0;
};

class ElementReader {
 public:
  ElementReader(const std::filesystem::path& path, std::string_view bytes, std::size_t at)
      : path_(path), bytes_(bytes), at_(at) {}

  std::size_t at() const { return at_; }
  std::uint16_t next_group() const { return at_ + 2 <= bytes_.size() ? number<std::uint16_t>(at_) : 0; }

  /// The elements up to a byte, or to the end of an item of undefined length.
  DicomElements elements(std::size_t end, bool typed, int depth = 0) {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) fail("its sequences lie too deep in one another");
    DicomElements found;
    while (at_ < end) {
      const Head head = this->head(typed);
      if (head.tag == kItemEnd) return found;
      take(head, found, end, depth);
    }
    return found;
  }

  /// The next element alone.
  void take_next(DicomElements& to) { take(head(true), to, bytes_.size(), 0); }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw_damaged(path_, "byte " + number_text(at_) + ": " + why);
  }

  template <typename Number>
  Number number(std::size_t at) const {
    if (at + sizeof(Number) > bytes_.size()) fail("it ends too early");
    Number value = 0;
    for (std::size_t n = sizeof(Number); n-- > 0;)
      value = static_cast<Number>(value << 8U | static_cast<unsigned char>(bytes_[at + n]));
    return value;
  }

  template <typename Number>
  Number next() {
    const Number value = number<Number>(at_);
    at_ += sizeof(Number);
    return value;
  }

  Head head(bool typed) {
    Head head;
    head.tag = static_cast<DicomTag>(next<std::uint16_t>()) << 16U;
    head.tag |= next<std::uint16_t>();
    const bool is_delimiter = head.tag >> 16U == kItem >> 16U;
    if (!typed || is_delimiter) {
      head.has_typed_items = false;
      head.may_be_sequence = !is_delimiter;
      head.length = next<std::uint32_t>();
      return head;
    }
    const std::string_view type = at_ + 2 <= bytes_.size() ? bytes_.substr(at_, 2) : std::string_view();
    at_ += 2;
    const bool is_long = std::ranges::find(kLongTypes, type) != kLongTypes.end();
    head.may_be_sequence = type == "SQ" || type == "UN";
    head.has_typed_items = type == "SQ";
    if (is_long) at_ += 2;
    head.length = is_long ? next<std::uint32_t>() : next<std::uint16_t>();
    return head;
  }

  void take(const Head& head, DicomElements& to, std::size_t end, int depth) {
    const bool is_open = head.length == kUndefinedLength;
    if (head.tag == kPixelData && is_open) {
      throw InvalidInput(in_quotes(path_) + " has compressed voxels; uncompressed ones are needed");
    }
    if (!is_open && head.length > end - std::min(end, at_)) fail("it ends too early");
    const std::string_view value = is_open ? std::string_view() : bytes_.substr(at_, head.length);
    if (head.may_be_sequence && (is_open || value.starts_with("\xfe\xff\0\xe0"))) {
      to.sequences[head.tag] = items(is_open ? end : at_ + head.length, head.has_typed_items, depth);
    } else if (is_open) {
      fail("an element has no length");
    } else {
      to.values[head.tag] = value;
      at_ += head.length;
    }
  }

  std::vector<DicomElements> items(std::size_t end, bool typed, int depth) {
    std::vector<DicomElements> found;
    while (at_ < end) {
      const Head head = this->head(typed);
      if (head.tag == kSequenceEnd) return found;
      if (head.tag != kItem) fail("a sequence holds something that is no item");
      const bool is_open = head.length == kUndefinedLength;
      if (!is_open && head.length > end - at_) fail("it ends too early");
      found.push_back(elements(is_open ? end : at_ + head.length, typed, depth + 1));
    }
    return found;
  }

  const std::filesystem::path& path_;
  std::string_view bytes_;
  std::size_t at_;
};

/// Whether the elements behind the file's own have types.
bool is_typed(const std::filesystem::path& path, const DicomElements& meta) {
  const auto found = meta.values.find(kTransferSyntax);
  std::string_view syntax = found == meta.values.end() ? kImplicit : found->second;
  syntax = syntax.substr(0, syntax.find('\0'));
  if (syntax == kExplicit || syntax == kImplicit) return syntax == kExplicit;
  throw InvalidInput(in_quotes(path) + " has the DICOM transfer syntax " + std::string(syntax) +
                     "; an uncompressed little-endian one is needed");
}

}  // namespace

DicomElements dicom_elements(const std::filesystem::path& path, std::string_view file) {
  constexpr std::uint16_t kMetaGroup = 2;
  ElementReader reader(path, file, kBeginning);
  DicomElements meta;
  while (reader.next_group() == kMetaGroup) reader.take_next(meta);
  return reader.elements(file.size(), is_typed(path, meta));
}

}  // namespace anatomesh
