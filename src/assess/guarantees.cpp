// Which guarantees a mesh breaks, in words.
#include <sstream>

#include "anatomesh/assess.h"

namespace anatomesh {
namespace {

constexpr double kAngleRoundingDeg = 1e-6;
constexpr double kMeanRatioRounding = 1e-9;
constexpr double kInPlaceDice = 0.5;

/// A count that must be zero, and what to say of it.
struct Forbidden {
  std::uint64_t count;
  const char* one;
  const char* many;
};

template <class... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  text.precision(9);
  (text << ... << parts);
  return text.str();
}

void check_counts(const Assessment& a, std::vector<std::string>& failed) {
  const Conformity& c = a.conformity;
  const Quality& q = a.whole.quality;
  const Curves& curves = a.curves;
  const Forbidden table[] = {
      {q.inverted, "tetrahedron is inverted", "tetrahedra are inverted"},
      {q.degenerate, "tetrahedron has no volume", "tetrahedra have no volume"},
      {curves.folded, "curved tetrahedron may be folded: its Jacobian is not positive everywhere",
       "curved tetrahedra may be folded: their Jacobians are not positive everywhere"},
      {c.faces_in_more_than_two_tets, "face belongs to more than two tetrahedra",
       "faces belong to more than two tetrahedra"},
      {c.folded_tets, "tetrahedron overlaps the one behind a face", "tetrahedra overlap the one behind a face"},
      {c.hanging_vertices, "vertex hangs on an edge or face of other tetrahedra",
       "vertices hang on edges or faces of other tetrahedra"},
      {c.duplicate_vertices, "vertex lies at the place of another", "vertices lie at the place of another"},
      {c.unused_vertices, "vertex belongs to no tetrahedron", "vertices belong to no tetrahedron"},
      {c.voxel_centres_in_several_tets, "voxel centre lies in more than one tetrahedron: the mesh overlaps itself",
       "voxel centres lie in more than one tetrahedron: the mesh overlaps itself"},
  };
  for (const Forbidden& f : table) {
    if (f.count > 0) failed.push_back(sentence(f.count, " ", f.count == 1 ? f.one : f.many));
  }
  if (c.negative_orientation) failed.push_back("the tetrahedra are negatively oriented: their volumes are negative");
}

void check_angles(const char* which, double min_deg, double max_deg, const AssessOptions& o,
                  std::vector<std::string>& failed) {
  if (min_deg < o.min_dihedral_deg - kAngleRoundingDeg) {
    failed.push_back(
        sentence("the smallest ", which, " is ", min_deg, " degrees, below the bound of ", o.min_dihedral_deg));
  }
  if (max_deg > o.max_dihedral_deg + kAngleRoundingDeg) {
    failed.push_back(
        sentence("the largest ", which, " is ", max_deg, " degrees, above the bound of ", o.max_dihedral_deg));
  }
}

void check_bounds(const Assessment& a, const AssessOptions& o, std::vector<std::string>& failed) {
  const Quality& q = a.whole.quality;
  const Curves& curves = a.curves;
  check_angles("dihedral angle", q.min_dihedral_deg, q.max_dihedral_deg, o, failed);
  check_angles("dihedral angle of curved faces", curves.min_dihedral_deg, curves.max_dihedral_deg, o, failed);
  if (q.min_mean_ratio < o.min_mean_ratio - kMeanRatioRounding) {
    failed.push_back(
        sentence("the smallest mean ratio is ", q.min_mean_ratio, ", below the bound of ", o.min_mean_ratio));
  }
}

void check_against_image(const Assessment& a, std::vector<std::string>& failed) {
  for (const TissueAssessment& t : a.tissues) {
    if (!t.in_mesh) {
      failed.push_back(sentence("label ", t.label, " of the image (", t.fidelity.image_voxels,
                                t.fidelity.image_voxels == 1 ? " voxel" : " voxels", ") is missing in the mesh"));
    } else if (!t.in_image) {
      failed.push_back(sentence("label ", t.label, " of the mesh (", t.quality.tets,
                                t.quality.tets == 1 ? " tetrahedron" : " tetrahedra", ") is not in the image"));
    }
  }
  if (a.whole.in_mesh && a.whole.fidelity.dice < kInPlaceDice) {
    failed.push_back(sentence("the mesh does not lie in the image: the Dice coefficient of both is ",
                              a.whole.fidelity.dice, ", below ", kInPlaceDice));
  }
}

}  // namespace

std::vector<std::string> failed_guarantees(const Assessment& assessment, const AssessOptions& options) {
  std::vector<std::string> failed;
  if (!assessment.whole.in_mesh) failed.push_back("the mesh has no labelled tetrahedron");
  check_counts(assessment, failed);
  check_bounds(assessment, options, failed);
  if (assessment.has_image) check_against_image(assessment, failed);
  return failed;
}

}  // namespace anatomesh
