#include "io/file_checks.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/errors.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

/// The lines "key: value" or "key = value" at the start of a file.
struct TextHeader {
  std::map<std::string, std::string> fields;
  std::size_t bytes = 0;  ///< from the start of the file to what follows the header

  std::string get(const std::string& key, const std::string& otherwise) const {
    const auto found = fields.find(key);
    return found != fields.end() ? found->second : otherwise;
  }
};

std::string trimmed(std::string_view text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  while (!text.empty() && is_space(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  while (!text.empty() && is_space(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
  return std::string(text);
}

/// Reads lines up to an empty one or, including it, the one with the last key.
TextHeader read_text_header(const fs::path& path, char separator, std::string_view last_key) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  std::ifstream file(path, std::ios::binary);
  TextHeader header;
  for (std::string line; header.bytes < kMostBytes && std::getline(file, line);) {
    header.bytes += line.size() + 1;
    if (trimmed(line).empty()) break;
    const std::size_t at = line.find(separator);
    if (at == std::string::npos) continue;
    const std::string key = trimmed(std::string_view(line).substr(0, at));
    header.fields[key] = trimmed(std::string_view(line).substr(at + 1));
    if (key == last_key) break;
  }
  return header;
}

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) numbers.push_back(std::strtod(word.c_str(), nullptr));
  return numbers;
}

void check_spacing(const fs::path& path, const std::string& spacing) {
  for (const double number : numbers_in(spacing)) {
    if (std::isfinite(number) && number > 0) continue;
    throw InvalidInput(in_quotes(path) + " has the voxel spacing " + spacing + "; all must be above 0");
  }
}

/// Throws unless the compressed data (zlib's or gzip's) that begin at some byte of the file are whole: teem and
/// MetaIO take what is missing or broken for voxels.
void check_compressed(const fs::path& path, const fs::path& file, std::size_t begin) {
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(begin));
  constexpr int kEitherHeader = MAX_WBITS + 32;
  z_stream zip = {};
  if (inflateInit2(&zip, kEitherHeader) != Z_OK) throw IoError("zlib cannot be used");
  std::vector<Bytef> packed(std::size_t{1} << 18), unpacked(std::size_t{1} << 18);
  int status = Z_OK;
  while (status == Z_OK && stream) {
    stream.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
    zip.next_in = packed.data();
    zip.avail_in = static_cast<uInt>(stream.gcount());
    do {
      zip.next_out = unpacked.data();
      zip.avail_out = static_cast<uInt>(unpacked.size());
      status = inflate(&zip, Z_NO_FLUSH);
    } while (status == Z_OK && (zip.avail_in > 0 || zip.avail_out == 0));
    if (status == Z_BUF_ERROR) status = Z_OK;  // it only asks for more
  }
  inflateEnd(&zip);
  if (status == Z_STREAM_END) return;
  throw IoError(in_quotes(path) + " is truncated or damaged: its compressed voxels are " +
                (status == Z_OK ? "cut off" : "broken"));
}

void check_nrrd(const fs::path& path) {
  const TextHeader header = read_text_header(path, ':', "");
  // An axis that is not one of space may have the spacing NaN; such an image is refused for its dimension.
  if (header.get("dimension", "") == "3") check_spacing(path, header.get("spacings", ""));
  const std::string encoding = header.get("encoding", "raw");
  const bool is_detached = !header.get("data file", header.get("datafile", "")).empty();
  const bool skips = header.get("byte skip", header.get("byteskip", "0")) != "0" ||
                     header.get("line skip", header.get("lineskip", "0")) != "0";
  if ((encoding == "gzip" || encoding == "gz") && !is_detached && !skips) check_compressed(path, path, header.bytes);
}

/// Bytes of one number of a MetaImage, 0 if the type is none.
std::size_t meta_bytes(const std::string& type) {
  static const std::map<std::string, std::size_t> kBytes = {
      {"MET_CHAR", 1},      {"MET_UCHAR", 1},      {"MET_SHORT", 2}, {"MET_USHORT", 2},
      {"MET_INT", 4},       {"MET_UINT", 4},       {"MET_LONG", 4},  {"MET_ULONG", 4},
      {"MET_LONG_LONG", 8}, {"MET_ULONG_LONG", 8}, {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}};
  const auto found = kBytes.find(type);
  return found != kBytes.end() ? found->second : 0;
}

/// Bytes that the voxels of a MetaImage take in its file; 0 where its header does not tell.
double declared_meta_bytes(const TextHeader& header) {
  if (header.get("BinaryData", "True") != "True") return 0;
  if (header.get("CompressedData", "False") == "True") {
    return std::strtod(header.get("CompressedDataSize", "0").c_str(), nullptr);
  }
  double bytes = static_cast<double>(meta_bytes(header.get("ElementType", "")));
  for (const double size : numbers_in(header.get("DimSize", ""))) bytes *= size;
  return bytes * std::strtod(header.get("ElementNumberOfChannels", "1").c_str(), nullptr);
}

void check_meta_image(const fs::path& path) {
  const TextHeader header = read_text_header(path, '=', "ElementDataFile");
  for (const char* key : {"NDims", "DimSize", "ElementType", "ElementDataFile"}) {
    if (!header.get(key, "").empty()) continue;
    throw IoError(in_quotes(path) + " is truncated or damaged: its MetaImage header lacks " + key);
  }
  check_spacing(path, header.get("ElementSpacing", header.get("ElementSize", "")));
  const std::string data = header.get("ElementDataFile", "");
  if (data == "LIST" || data.find('%') != std::string::npos) return;
  const bool is_local = data == "LOCAL" || data == "Local" || data == "local";
  const fs::path file = is_local ? path : path.parent_path() / data;
  if (!fs::is_regular_file(file)) {
    throw IoError("the voxels of " + in_quotes(path) + " are missing: there is no file " + in_quotes(file));
  }
  const double begin = is_local ? static_cast<double>(header.bytes)
                                : std::max(0.0, std::strtod(header.get("HeaderSize", "0").c_str(), nullptr));
  const double present = static_cast<double>(fs::file_size(file)) - begin;
  if (present >= declared_meta_bytes(header)) {
    const bool is_compressed = header.get("CompressedData", "False") == "True";
    if (is_compressed) check_compressed(path, file, static_cast<std::size_t>(begin));
    return;
  }
  throw IoError(in_quotes(path) + " is truncated: it has " + number_text(std::max(0.0, present)) + " of the " +
                number_text(declared_meta_bytes(header)) + " bytes of its voxels");
}

/// MINC 1 is netCDF, MINC 2 is HDF5.
void check_minc(const fs::path& path) {
  std::array<char, 4> start = {};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  const std::string_view text(start.data(), start.size());
  if (text == "\x89HDF" || text.substr(0, 3) == "CDF") return;
  throw IoError(in_quotes(path) + " is truncated, damaged or not in the format of its extension, MINC");
}

/// What is known about the reading of files by their extension.
struct FileKind {
  std::string_view extension;
  void (*check)(const fs::path& path);
  bool library_prints;
  bool library_crashes;
};

constexpr std::array<FileKind, 5> kFileKinds = {{{".nrrd", &check_nrrd, false, false},
                                                 {".nhdr", &check_nrrd, false, false},
                                                 {".mha", &check_meta_image, true, false},
                                                 {".mhd", &check_meta_image, true, false},
                                                 {".mnc", &check_minc, true, true}}};

const FileKind* kind_of(const fs::path& path) {
  const std::string extension = file_extension(path);
  const auto found = std::find_if(kFileKinds.begin(), kFileKinds.end(),
                                  [&](const FileKind& kind) { return kind.extension == extension; });
  return found != kFileKinds.end() ? &*found : nullptr;
}

std::uint32_t u32_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (std::size_t n = 4; n-- > 0;) number = number << 8 | static_cast<unsigned char>(bytes[at + n]);
  return number;
}

}  // namespace

void check_before_itk(const fs::path& path) {
  if (const FileKind* kind = kind_of(path)) kind->check(path);
}

bool is_read_by_printing_library(const fs::path& path) {
  const FileKind* const kind = kind_of(path);
  return kind != nullptr && kind->library_prints;
}

bool is_read_by_crashing_library(const fs::path& path) {
  const FileKind* const kind = kind_of(path);
  return kind == nullptr || kind->library_crashes;
}

void check_dicom_pixels(const fs::path& path, std::size_t least_bytes) {
  std::ifstream stream(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  constexpr std::string_view kPixelData = {"\xe0\x7f\x10\x00", 4};  // the tag (7FE0,0010), little endian
  constexpr std::uint32_t kUndefinedLength = 0xffffffff;            // compressed: GDCM's decoders notice
  for (std::size_t at = bytes.find(kPixelData); at != std::string::npos; at = bytes.find(kPixelData, at + 1)) {
    if (at + 12 > bytes.size()) break;
    const std::string_view type = std::string_view(bytes).substr(at + 4, 2);
    const std::size_t length_at = at + (type == "OW" || type == "OB" ? 8 : 4);
    const std::uint32_t length = u32_at(bytes, length_at);
    if (length == kUndefinedLength || length < least_bytes) continue;
    if (length <= bytes.size() - length_at - 4) return;
    throw IoError(in_quotes(path) + " is truncated: it has " + number_text(bytes.size() - length_at - 4) + " of the " +
                  number_text(length) + " bytes of its pixels");
  }
}

}  // namespace anatomesh
