// After the HDF5 Reference Manual, library version 1.10 (https://docs.hdfgroup.org/hdf5/v1_10/).
#include "io/hdf5_file.h"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <new>
#include <utility>

#include "anatomesh/errors.h"
#include "io/cell_arrays.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/reader_process.h"

namespace anatomesh {
namespace {

/// While it lives, the library does not print errors of its own.
class MutedHdf5 {
 public:
  MutedHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &with_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~MutedHdf5() { H5Eset_auto2(H5E_DEFAULT, print_, with_); }
  MutedHdf5(const MutedHdf5&) = delete;
  MutedHdf5& operator=(const MutedHdf5&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* with_ = nullptr;
};

/// An id of the library that is closed at the end of its scope.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): it is passed to the library as such
  bool is_open() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// ---- writing

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr unsigned kGzipLevel = 1;

/// How numbers lie in the file and in memory.
struct StoredType {
  hid_t in_file;
  hid_t in_memory;
};

StoredType stored_type(NumberType type) {
  switch (type) {
    case NumberType::f64:
      return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE};
    case NumberType::i64:
      return {H5T_STD_I64LE, H5T_NATIVE_INT64};
    case NumberType::i32:
      return {H5T_STD_I32LE, H5T_NATIVE_INT32};
    case NumberType::u32:
      return {H5T_STD_U32LE, H5T_NATIVE_UINT32};
    case NumberType::u8:
      return {H5T_STD_U8LE, H5T_NATIVE_UINT8};
    default:
      throw std::bad_alloc();  // no other is written
  }
}

// In memory there is nothing that can go wrong but memory.
void require(bool done) {
  if (!done) throw std::bad_alloc();
}

hid_t memory_access() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  require(H5Pset_fapl_core(access, kChunkBytes, false) >= 0);
  return access;
}

// No two files in memory may have the same name; it does not show in their bytes.
std::string unused_name() {
  static std::atomic<unsigned> count = 0;
  return "image " + number_text(count++);
}

// Groups on the way are made as well.
hid_t link_creation() {
  const hid_t creation = H5Pcreate(H5P_LINK_CREATE);
  require(H5Pset_create_intermediate_group(creation, 1) >= 0);
  return creation;
}

// Without the time of day.
hid_t dataset_creation() {
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  require(H5Pset_obj_track_times(creation, false) >= 0);
  return creation;
}

}  // namespace

struct Hdf5Image::Handles {
  MutedHdf5 muted;
  Handle access{memory_access(), &H5Pclose};
  Handle links{link_creation(), &H5Pclose};
  Handle file{H5Fcreate(unused_name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), &H5Fclose};
};

Hdf5Image::Hdf5Image() : handles_(std::make_unique<Handles>()) { require(handles_->file.is_open()); }
Hdf5Image::~Hdf5Image() = default;

void Hdf5Image::add(const std::string& dataset, NumberType type, const void* values, std::size_t rows,
                    std::size_t columns) {
  const int rank = columns == 1 ? 1 : 2;
  const std::array<hsize_t, 2> shape = {rows, columns};
  const std::size_t rows_a_chunk = std::max<std::size_t>(kChunkBytes / (columns * bytes_of(type)), 1);
  const std::array<hsize_t, 2> chunk = {std::min(rows, rows_a_chunk), columns};
  const Handle space(H5Screate_simple(rank, shape.data(), nullptr), &H5Sclose);
  const Handle creation(dataset_creation(), &H5Pclose);
  if (rows > 0) {
    require(H5Pset_chunk(creation, rank, chunk.data()) >= 0 && H5Pset_shuffle(creation) >= 0 &&
            H5Pset_deflate(creation, kGzipLevel) >= 0);
  }
  const StoredType stored = stored_type(type);
  const Handle set(
      H5Dcreate2(handles_->file, dataset.c_str(), stored.in_file, space, handles_->links, creation, H5P_DEFAULT),
      &H5Dclose);
  require(set.is_open());
  if (rows > 0) require(H5Dwrite(set, stored.in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
}

void Hdf5Image::add(const std::string& dataset, const std::vector<std::string>& texts) {
  std::vector<const char*> values;
  for (const std::string& text : texts) values.push_back(text.c_str());
  const hsize_t count = values.size();
  const Handle type(H5Tcopy(H5T_C_S1), &H5Tclose);
  require(H5Tset_size(type, H5T_VARIABLE) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0);
  const Handle space(H5Screate_simple(1, &count, nullptr), &H5Sclose);
  const Handle creation(dataset_creation(), &H5Pclose);
  const Handle set(H5Dcreate2(handles_->file, dataset.c_str(), type, space, handles_->links, creation, H5P_DEFAULT),
                   &H5Dclose);
  require(set.is_open());
  if (count > 0) require(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
}

std::string Hdf5Image::bytes() const {
  require(H5Fflush(handles_->file, H5F_SCOPE_LOCAL) >= 0);
  const ssize_t size = H5Fget_file_image(handles_->file, nullptr, 0);
  require(size > 0);
  std::string image(static_cast<std::size_t>(size), '\0');
  require(H5Fget_file_image(handles_->file, image.data(), image.size()) == size);
  return image;
}

// ---- reading

namespace {

constexpr std::uint64_t kMostInflation = 1100;  // of deflate, which ends at 1032

/// A dataset of a file, looked at before it is read.
struct OpenedDataset {
  const std::filesystem::path& path;
  const std::string& name;
  Handle set;
  Handle type;
  Handle space;
  Handle creation;

  OpenedDataset(const std::filesystem::path& in, hid_t file, hid_t access, const std::string& dataset)
      : path(in),
        name(dataset),
        set(H5Dopen2(file, dataset.c_str(), access), &H5Dclose),
        type(H5Dget_type(set), &H5Tclose),
        space(H5Dget_space(set), &H5Sclose),
        creation(H5Dget_create_plist(set), &H5Pclose) {
    if (!set.is_open() || !type.is_open() || !space.is_open() || !creation.is_open()) fail("cannot be opened");
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw_damaged(path, "the dataset " + in_quotes(name) + " " + why);
  }

  H5T_class_t type_class() const { return H5Tget_class(type); }

  /// Bytes of what is unpacked at once: all of it, or a chunk.
  std::uint64_t largest_piece(std::uint64_t count) const {
    std::array<hsize_t, H5S_MAX_RANK> chunk;
    std::uint64_t piece = 1;
    const bool is_chunked = H5Pget_layout(creation) == H5D_CHUNKED;
    const int rank = is_chunked ? H5Pget_chunk(creation, H5S_MAX_RANK, chunk.data()) : 0;
    // The library would search for the end of such chunks without end.
    if (is_chunked && rank != H5Sget_simple_extent_ndims(space)) fail("has chunks of another shape");
    for (int axis = 0; axis < rank; ++axis) {
      if (__builtin_mul_overflow(piece, chunk[static_cast<std::size_t>(axis)], &piece)) fail("has absurd chunks");
    }
    if (__builtin_mul_overflow(std::max(piece, count), 8u, &piece)) fail("is absurdly large");
    return piece;
  }

  void check_holds(std::uint64_t count) const {
    const H5D_layout_t layout = H5Pget_layout(creation);
    if (layout == H5D_VIRTUAL || layout < 0 || H5Pget_external_count(creation) != 0) fail("lies in other files");
    const hssize_t points = H5Sget_simple_extent_npoints(space);
    if (points < 0 || static_cast<std::uint64_t>(points) != count) {
      fail("has " + number_text(points) + " numbers where " + number_text(count) + " are expected");
    }
    std::error_code none;
    const std::uint64_t stored = H5Dget_storage_size(set), on_disk = std::filesystem::file_size(path, none);
    const std::uint64_t inflation = H5Pget_nfilters(creation) == 0 ? 8 : 8 * kMostInflation;  // bytes become 64-bit
    if (stored > on_disk || largest_piece(count) / inflation > stored) fail("claims more than the file can hold");
  }
};

herr_t no_other_file(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) { return -1; }

hid_t dataset_access() {
  const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
  H5Pset_elink_cb(access, &no_other_file, nullptr);
  return access;
}

hid_t native_type(double) { return H5T_NATIVE_DOUBLE; }
hid_t native_type(std::int64_t) { return H5T_NATIVE_INT64; }

template <typename Value>
std::vector<Value> numbers_of(const OpenedDataset& opened, std::uint64_t count) {
  const H5T_class_t kind = opened.type_class();
  const bool is_real = kind == H5T_FLOAT;
  if ((!is_real && kind != H5T_INTEGER) || H5Tget_size(opened.type) > 8) opened.fail("holds no numbers");
  if (is_real && std::is_integral_v<Value>) opened.fail("holds reals where integers are expected");
  opened.check_holds(count);
  std::vector<Value> values(count);
  if (count > 0 && H5Dread(opened.set, native_type(Value{}), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    opened.fail("cannot be read");
  }
  return values;
}

/// What may be asked of a dataset.
enum class Question : std::uint32_t { holds_reals, reals, integers };

void answer(Question question, const OpenedDataset& opened, std::uint64_t count, ProcessChannel& parent) {
  switch (question) {
    case Question::holds_reals:
      return parent.put_one<char>(opened.type_class() == H5T_FLOAT);
    case Question::reals:
      return parent.put(numbers_of<double>(opened, count));
    case Question::integers:
      return parent.put(numbers_of<std::int64_t>(opened, count));
  }
}

/// Until the channel throws.
void answer_all(const std::filesystem::path& path, ProcessChannel& parent) {
  const Handle access(dataset_access(), &H5Pclose);
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), &H5Fclose);
  if (!file.is_open()) throw_damaged(path, "it is no HDF5 file");
  for (;;) {
    const auto question = parent.get_one<Question>();
    const auto count = parent.get_one<std::uint64_t>();
    const std::string dataset = parent.get_text();
    answer(question, OpenedDataset(path, file, access, dataset), count, parent);
  }
}

ProcessChannel& ask(ReaderProcess& process, Question question, const std::string& dataset, std::uint64_t count) {
  process.child().put_one(question);
  process.child().put_one(count);
  process.child().put(dataset);
  return process.child();
}

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path) {
  require_readable(path);
  process_ = std::make_unique<ReaderProcess>(path, [&](ProcessChannel& parent) { answer_all(path, parent); });
}
Hdf5File::~Hdf5File() = default;

bool Hdf5File::holds_reals(const std::string& dataset) const {
  return ask(*process_, Question::holds_reals, dataset, 0).get_one<char>() != 0;
}

std::vector<double> Hdf5File::reals(const std::string& dataset, std::uint64_t count) const {
  return ask(*process_, Question::reals, dataset, count).get_list<double>(count);
}

std::vector<std::int64_t> Hdf5File::integers(const std::string& dataset, std::uint64_t count) const {
  return ask(*process_, Question::integers, dataset, count).get_list<std::int64_t>(count);
}

}  // namespace anatomesh
