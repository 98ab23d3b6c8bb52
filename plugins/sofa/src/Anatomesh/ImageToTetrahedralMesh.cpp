#include <Anatomesh/ImageToTetrahedralMesh.h>
#include <Anatomesh/MeshCache.h>
#include <sofa/core/ObjectFactory.h>

#include <cmath>

#include "anatomesh/errors.h"
#include "anatomesh/image_to_mesh.h"
#include "anatomesh/io.h"

namespace anatomesh::simulation {
namespace {

using sofa::core::objectmodel::PathType;

/// Fills in Options::labels. Throws InvalidOption where an option names a label that the image has not.
void resolve_labels(Options& options, const std::vector<LabelRange>& ranges, const LabelCounts& present) {
  for (const auto& [label, fidelity] : options.lattice.fidelity_label) require_label(label, present, "fidelityLabel");
  for (const auto& [label, size] : options.lattice.size_label) require_label(label, present, "sizeLabel");
  for (const auto& [label, material] : options.deform.material)
    require_label(label, present, "tissue, young or poisson");
  options.labels = select_labels(ranges, present, "labels");
}

}  // namespace

bool ImageFileNames::read(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || text[first] == '[') return DataFileNameVector::read(text);
  sofa::type::SVector<std::string> names;
  names.push_back(text.substr(first, text.find_last_not_of(" \t\r\n") + 1 - first));
  setValue(names);
  return true;
}

ImageToTetrahedralMesh::ImageToTetrahedralMesh()
    : d_filename(initData(&d_filename, "filename",
                          "segmented image, or a folder with one DICOM series; ['a.nrrd', 'b.nrrd']: masks of one "
                          "tissue each, labelled 1, 2, ...")),
      d_dimensions(initData(&d_dimensions, "dimensions", "voxels along i, j and k, where there is no filename")),
      d_spacing(initData(&d_spacing, {1, 1, 1}, "spacing", "distance of voxel centres along i, j and k, mm")),
      d_origin(initData(&d_origin, "origin", "centre of the first voxel, LPS, mm")),
      d_direction(initData(&d_direction, sofa::type::Mat3x3d::Identity(), "direction",
                           "columns: unit vectors of i, j and k in LPS")),
      d_voxels(initData(&d_voxels, "voxels", "label of each voxel, i fastest")),
      options(*this),
      d_cacheDirectory(initData(&d_cacheDirectory, "cacheDirectory",
                                "folder where meshes are kept and looked for, by the content of image and options")) {
  d_filename.setPathType(PathType::BOTH);
  d_cacheDirectory.setPathType(PathType::DIRECTORY);
  for (sofa::core::BaseData* input : std::initializer_list<sofa::core::BaseData*>{
           &d_filename, &d_dimensions, &d_spacing, &d_origin, &d_direction, &d_voxels, &d_cacheDirectory})
    addInput(input);
  for (sofa::core::BaseData* option : options.all()) addInput(option);
}

TetMesh ImageToTetrahedralMesh::makeMesh() {
  MeshRequest request = options.request();
  addMaterials(request);
  Options asked = options_of(request);
  check_options(asked);
  const LabelImage image = readImage();
  check_image(image);
  resolve_labels(asked, request.ranges, count_labels(image));
  TetMesh mesh = meshOrCached(image, asked);
  msg_info() << mesh.tets.size() << " tetrahedra, " << mesh.points_mm.size() << " vertices";
  return mesh;
}

LabelImage ImageToTetrahedralMesh::readImage() {
  const std::size_t files = d_filename.getValue().size();
  if (files == 0) return imageOfData();
  if (!d_voxels.getValue().empty())
    throw InvalidInput("both filename and voxels are given; the image must come from one of them");
  std::vector<std::filesystem::path> paths;
  for (unsigned f = 0; f < files; ++f) paths.emplace_back(d_filename.getFullPath(f));
  ImageFile file = files == 1 ? read_label_image(paths.front()) : read_label_masks(paths);
  for (const std::string& note : file.notes) msg_warning() << note;
  return std::move(file.image);
}

LabelImage ImageToTetrahedralMesh::imageOfData() const {
  if (d_voxels.getValue().empty())
    throw InvalidInput("there is no image; give a filename, or dimensions, spacing and voxels");
  const auto& size = d_dimensions.getValue();
  const auto& spacing = d_spacing.getValue();
  const auto& origin = d_origin.getValue();
  LabelImage image;
  image.size = {size[0], size[1], size[2]};
  image.spacing_mm = {spacing[0], spacing[1], spacing[2]};
  image.origin_mm = {origin[0], origin[1], origin[2]};
  for (unsigned r = 0; r < 3; ++r)
    for (unsigned c = 0; c < 3; ++c) image.direction[r][c] = d_direction.getValue()(r, c);
  image.voxels.assign(d_voxels.getValue().begin(), d_voxels.getValue().end());
  return image;
}

TetMesh ImageToTetrahedralMesh::meshOrCached(const LabelImage& image, const Options& asked) {
  if (d_cacheDirectory.getValue().empty()) return meshImage(image, asked);
  const std::filesystem::path kept = cached_mesh(d_cacheDirectory.getFullPath(), content_hash(image, asked));
  try {
    if (std::filesystem::exists(kept)) {
      TetMesh mesh = read_mesh(kept);
      msg_info() << "mesh taken from " << kept;
      return mesh;
    }
  } catch (const Error& error) {
    msg_warning() << error.what() << "; the image is meshed again";
  }
  TetMesh mesh = meshImage(image, asked);
  try {
    write_mesh(kept, mesh);
  } catch (const Error& error) {
    msg_warning() << error.what() << "; the mesh is not kept";
  }
  return mesh;
}

TetMesh ImageToTetrahedralMesh::meshImage(const LabelImage& image, const Options& asked) {
  Progress progress;
  int told = -1;
  progress.report = [&](std::string_view stage, double fraction) {
    const int tenth = static_cast<int>(std::floor(10 * fraction));
    if (tenth > told) msg_info() << stage << ", " << 10 * tenth << " %";
    told = std::max(told, tenth);
  };
  Result result = image_to_mesh(image, asked, progress);
  if (result.mesh.tets.empty()) throw MeshingFailed("no tetrahedron could be made; a smaller minSize may do");
  for (const std::string& warning : result.warnings) msg_warning() << with_data_names(warning);
  return std::move(result.mesh);
}

void registerImageToTetrahedralMesh(sofa::core::ObjectFactory* factory) {
  factory->registerObjects(
      sofa::core::ObjectRegistrationData("Tetrahedral mesh of the tissues of a segmented image, with its surfaces, its "
                                         "interfaces and the materials of its tetrahedra.")
          .add<ImageToTetrahedralMesh>());
}

}  // namespace anatomesh::simulation
