// VTK's XML files: the tree of their elements, and their arrays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/number_array.h"
#include "io/vtk_xml_data.h"

namespace anatomesh {

/// A file in memory.
class VtkXmlFile {
 public:
  /// Reads the whole file, which must hold a data set of this type. Throws IoError, InvalidInput (a compressor that is
  /// not known).
  VtkXmlFile(const std::filesystem::path& path, const char* type);
  VtkXmlFile(const VtkXmlFile&) = delete;
  VtkXmlFile& operator=(const VtkXmlFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  pugi::xml_node data_set() const { return data_set_; }

  /// All numbers of an array. Throws IoError.
  NumberArray numbers(pugi::xml_node array) const;

 private:
  void cut_appended_off();
  void read_root(const char* type);
  std::vector<std::byte> binary(pugi::xml_node array, const ArrayPlace& place) const;
  std::vector<std::byte> bytes_of(pugi::xml_node array, NumberType type) const;
  std::string_view appended_from(std::size_t offset) const;

  std::filesystem::path path_;
  std::string bytes_;  ///< of the file; empty where all of it is the head
  std::string head_;   ///< what the tree was parsed from, and refers to
  std::string_view appended_;
  bool is_appended_base64_ = false;
  std::vector<std::size_t> appended_offsets_;  ///< where arrays begin, sorted
  VtkXmlStorage storage_;
  pugi::xml_document document_;
  pugi::xml_node data_set_;
};

/// The type of numbers an array says it has. Nothing for bits and unknown ones.
std::optional<NumberType> number_type_of(pugi::xml_node array);

/// "Name" of an array, or of whatever else has one.
std::string_view name_of(pugi::xml_node array);

}  // namespace anatomesh
