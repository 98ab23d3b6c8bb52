#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/itk_session.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

template <typename Value>
std::vector<std::byte> bytes_as(const std::vector<Label>& labels) {
  std::vector<std::byte> bytes(labels.size() * sizeof(Value));
  for (std::size_t n = 0; n < labels.size(); ++n) {
    const auto value = static_cast<Value>(labels[n]);
    std::memcpy(bytes.data() + n * sizeof(Value), &value, sizeof(Value));
  }
  return bytes;
}

/// An integer type that a file may hold.
struct StoredType {
  Label most;
  itk::IOComponentEnum component;
  std::vector<std::byte> (*bytes)(const std::vector<Label>&);
};

constexpr std::array<StoredType, 3> kStoredTypes = {{
    {UINT8_MAX, itk::IOComponentEnum::UCHAR, &bytes_as<std::uint8_t>},
    {UINT16_MAX, itk::IOComponentEnum::USHORT, &bytes_as<std::uint16_t>},
    {UINT32_MAX, itk::IOComponentEnum::UINT, &bytes_as<std::uint32_t>},
}};

const StoredType& smallest_type(const std::vector<Label>& labels) {
  const Label largest = labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end());
  return *std::find_if(kStoredTypes.begin(), kStoredTypes.end(),
                       [&](const StoredType& type) { return largest <= type.most; });
}

itk::ImageIOBase::Pointer format_for_writing(const std::filesystem::path& path) {
  // Formats of one file only: two cannot be put in place at once.
  constexpr std::array kExtensions = {".nii", ".nii.gz", ".nrrd", ".mha", ".mnc"};
  if (std::find(kExtensions.begin(), kExtensions.end(), file_extension(path)) != kExtensions.end()) {
    for (const auto& format : image_formats()) {
      if (format->CanWriteFile(path.c_str())) return format;
    }
  }
  throw InvalidInput("cannot write the image " + in_quotes(path) +
                     ": the extension must be one of .nii, .nii.gz, .nrrd, .mha, .mnc");
}

void describe(const LabelImage& image, const StoredType& type, itk::ImageIOBase& io) {
  io.SetNumberOfDimensions(3);
  io.SetNumberOfComponents(1);
  io.SetPixelType(itk::IOPixelEnum::SCALAR);
  io.SetComponentType(type.component);
  io.UseCompressionOn();
  itk::ImageIORegion region(3);
  for (unsigned axis = 0; axis < 3; ++axis) {
    region.SetSize(axis, image.size[axis]);
    io.SetDimensions(axis, image.size[axis]);
    io.SetSpacing(axis, image.spacing_mm[axis]);
    io.SetOrigin(axis, image.origin_mm[axis]);
    io.SetDirection(axis,
                    std::vector<double>{image.direction[0][axis], image.direction[1][axis], image.direction[2][axis]});
  }
  io.SetIORegion(region);
}

void write_through_itk(const std::filesystem::path& file, const LabelImage& image) {
  const ItkSession itk_session;
  const StoredType& type = smallest_type(image.voxels);
  const itk::ImageIOBase::Pointer io = format_for_writing(file);
  io->SetFileName(file.string());
  describe(image, type, *io);
  io->WriteImageInformation();
  io->Write(type.bytes(image.voxels).data());
}

}  // namespace

void write_label_image(const std::filesystem::path& path, const LabelImage& image) {
  if (image.voxels.size() != image.size[0] * image.size[1] * image.size[2]) {
    throw InvalidInput("cannot write the image " + in_quotes(path) + ": its size does not match its number of voxels");
  }
  OutputFile file(path);
  try {
    write_through_itk(file.temporary(), image);
  } catch (const itk::ExceptionObject& error) {
    throw IoError("cannot write " + in_quotes(path) + ": " + description(error));
  }
  // Not every writer of ITK notices a full disk, and not every format holds all labels.
  bool is_same = false;
  try {
    is_same = read_label_image(file.temporary()).image.voxels == image.voxels;
  } catch (const Error&) {
    is_same = false;
  }
  if (!is_same) {
    throw IoError("cannot write " + in_quotes(path) +
                  ": it does not read back as it was, so the disk is full or the format cannot hold the image");
  }
  file.commit();
}

}  // namespace anatomesh
