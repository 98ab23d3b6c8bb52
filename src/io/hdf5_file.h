// HDF5 files: arrays of numbers under names such as "/mesh/points".
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/voxel_type.h"

namespace anatomesh {

class ReaderProcess;

/// A file on its way, in memory. The same calls give the same bytes.
class Hdf5Image {
 public:
  Hdf5Image();
  ~Hdf5Image();
  Hdf5Image(const Hdf5Image&) = delete;
  Hdf5Image& operator=(const Hdf5Image&) = delete;

  /// Rows of as many columns each, compressed; a plain list where there is one column.
  void add(const std::string& dataset, NumberType type, const void* values, std::size_t rows, std::size_t columns);
  /// One text each, UTF-8.
  void add(const std::string& dataset, const std::vector<std::string>& texts);

  /// The whole file.
  std::string bytes() const;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

/// A file to read from, in a process of its own (reader_process.h), since the library crashes on some damaged files.
/// All of it throws IoError where the file is damaged or lacks the dataset, also where it claims more numbers than its
/// bytes can hold, before memory is reserved for them. Data in further files are not followed.
class Hdf5File {
 public:
  explicit Hdf5File(const std::filesystem::path& path);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Whether the dataset holds reals and not integers.
  bool holds_reals(const std::string& dataset) const;
  /// All its numbers, so many.
  std::vector<double> reals(const std::string& dataset, std::uint64_t count) const;
  /// All its numbers, so many, which are integers.
  std::vector<std::int64_t> integers(const std::string& dataset, std::uint64_t count) const;

 private:
  std::unique_ptr<ReaderProcess> process_;
};

}  // namespace anatomesh
