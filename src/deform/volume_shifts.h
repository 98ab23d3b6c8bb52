// How far the boundaries have to be shifted for the tissues to have the volumes of their voxels.
#pragma once

#include <utility>
#include <vector>

#include "deform/interface_faces.h"

namespace anatomesh {

/// Chords of a coarse mesh and parts too thin for it lose some volume; a vertex that the guard stopped may lose or win
/// some. The boundaries of a tissue are shifted by so much that the shifts times the areas of its contacts are what it
/// lacks.
class VolumeShifts {
 public:
  explicit VolumeShifts(const TissueImage& image);

  /// The same for a part of a mesh whose tissues go on beyond it: wanted_mm3 are enclosed_volumes() as they are to
  /// become, by tissue.
  VolumeShifts(const TissueImage& image, std::vector<double> wanted_mm3)
      : image_(image), wanted_mm3_(std::move(wanted_mm3)), by_low_(image.labels.size()) {}

  /// Corrects the shifts by what the tissues lack in the mesh as it is. Cost: linear in the faces, and for
  /// each in the number of tissues that its lower tissue touches.
  void update(const TissueMesh& mesh, const InterfaceFaces& interfaces);

  /// How far beyond where it is the boundary of two tissues is to lie, mm from the lower number to the higher; a share
  /// of a voxel at the most.
  double between(TissueId low, TissueId high) const;

 private:
  struct Shift {
    TissueId high;
    double mm = 0;
  };
  Shift& shift_of(TissueId low, TissueId high);

  const TissueImage& image_;
  std::vector<double> wanted_mm3_;
  std::vector<std::vector<Shift>> by_low_;
};

/// What the interface faces say of each tissue's volume (mm^3), by the divergence theorem. In a part of a mesh it is
/// off by what the cut would add, which stays the same as long as the cut does.
std::vector<double> enclosed_volumes(const TissueMesh& mesh, const InterfaceFaces& interfaces, std::size_t tissues);

}  // namespace anatomesh
