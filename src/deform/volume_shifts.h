// How far the boundaries have to be shifted for the tissues to have the volumes of their voxels.
#pragma once

#include <vector>

#include "deform/interface_faces.h"

namespace anatomesh {

/// Chords of a coarse mesh and parts too thin for it lose some volume; a vertex that the guard stopped may lose or win
/// some. The boundaries of a tissue are shifted by so much that the shifts times the areas of its contacts are what it
/// lacks.
class VolumeShifts {
 public:
  explicit VolumeShifts(const TissueImage& image) : image_(image), by_low_(image.labels.size()) {}

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
  std::vector<std::vector<Shift>> by_low_;
};

}  // namespace anatomesh
