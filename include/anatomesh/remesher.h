// A mesh that follows changes of its image.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "anatomesh/image_to_mesh.h"

namespace anatomesh {

/// What an update of a mesh has done.
struct UpdateReport {
  std::uint64_t changed_voxels = 0;  ///< with another label than before
  std::uint64_t new_tets = 0;        ///< tetrahedra made anew; all others are what they were, to the last bit
  bool whole = false;                ///< all of the mesh was made anew, as image_to_mesh() does it
  std::string reason;                ///< why, where it was: one sentence; else empty
  double seconds = 0;                ///< wall-clock time
};

/// Meshes an image and then follows changes of its labels, such as a resection or the stroke of a brush, by meshing
/// anew only what is near them. Every mesh has the guarantees of one by image_to_mesh(); it is not the same mesh. Where
/// a guarantee cannot be kept that way, all is meshed anew, and the report says why. The same images in the
/// same order, and the same options, give the same bytes, whatever the number of threads.
class Remesher {
 public:
  /// Meshes the image. result() is that of image_to_mesh(). Memory: about 150 bytes a tetrahedron and 2 a voxel
  /// beside the result. Throws what image_to_mesh() does.
  explicit Remesher(const LabelImage& image, const Options& options = {}, const Progress& progress = {});
  ~Remesher();
  Remesher(Remesher&&) noexcept;
  Remesher& operator=(Remesher&&) noexcept;

  /// Brings the mesh up to date with an image of the same size, spacing, origin and direction; labels may come and go.
  /// Cost: that of meshing what is near the changed voxels, and some passes over the voxels and the mesh (a few per
  /// cent of the time for all of it). Throws InvalidInput (another grid, no label left), Cancelled, and what
  /// image_to_mesh() does; the mesh is then what it was before.
  UpdateReport update(const LabelImage& changed, const Progress& progress = {});

  /// The mesh as it is now, and what is known of its tissues. In an update that was not whole, `times` stay those of
  /// the last whole meshing, and so do lattice_f1 and lattice_f2.
  const Result& result() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace anatomesh
