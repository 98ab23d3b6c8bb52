// How fine the lattice must be along the surface of each tissue.
#pragma once

#include <span>
#include <vector>

#include "image/tissue_image.h"
#include "lattice/label_lattice.h"

namespace anatomesh {

/// Gives a plan the spacing of its root lattice, as many levels as go above the smallest spacing, and further ones for
/// tissues of one voxel.
void set_root(LatticePlan& plan, const TissueImage& image, double root_mm, double smallest_mm);

/// Spacing of a lattice along the surface of a tissue, in mean thicknesses of it (volume over area), with which about
/// this share of its voxels is wrong.
double spacing_for(double wrong);

/// Surfaces of large tissues have to lie near their boundary, too: how thick a layer of wrong voxels may be all over it
/// (mm) where this share of the tissue's voxels may be wrong.
double wrong_layer_mm(const TissueImage& image, double wrong);

/// Chooses the spacing of the lattice along each tissue's surface: the same all along it, since surfaces made of
/// tetrahedra of one size were measured to be smoother, nearer and of fewer tetrahedra than those refined here and
/// there to the same fidelity. A first guess comes from the tissue's volume and surface, better ones from what a
/// deformed mesh has reached. Holds a reference to the image, which must outlive it.
class SurfaceSizes {
 public:
  /// Spacings of the root lattice to choose from, and the smallest spacing of a surface, mm.
  struct Range {
    double smallest_root_mm, largest_root_mm, smallest_mm;
  };
  /// A lattice, and the level of it along the surface of each tissue.
  struct Choice {
    double root_mm = 0;
    int levels = 0;                  ///< to the smallest spacing
    std::vector<int> surface_level;  ///< by tissue, [0] unused
    bool operator==(const Choice&) const = default;
  };

  /// For a fidelity by tissue, [0] unused; 1: as fine as may be.
  SurfaceSizes(const TissueImage& image, const Range& range, std::span<const double> wanted);

  /// Enlarges the spacings to those of a mesh of about so many tetrahedra, shared out among the tissues so that the
  /// mean of what they lack is least, but in halvings of one of them; those that are larger stay.
  void fit_budget(double tets);

  /// Makes all spacings larger or smaller.
  void scale(double factor);

  /// The lattice that comes near the spacings with the fewest tetrahedra.
  Choice choose() const;

  /// Learns from what a mesh deformed from a lattice has reached. Whether another lattice would pay.
  bool correct(const Choice& used, std::span<const Fidelity> reached);

 private:
  double cost(const Choice& choice) const;

  const TissueImage& image_;
  Range range_;
  std::vector<double> area_mm2_;
  std::vector<double> wrong_;    // share of its voxels that may be wrong, by tissue
  std::vector<double> size_mm_;  // spacing of the lattice along its surface
  std::vector<double> last_wrong_;
};

}  // namespace anatomesh
