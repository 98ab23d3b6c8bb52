// A ball within a ball, from an array in memory to a mesh, and how good that is.
#include <anatomesh/assess.h>
#include <anatomesh/image_to_mesh.h>

#include <cmath>
#include <cstdio>

int main() {
  anatomesh::LabelImage image;
  image.size = {48, 48, 48};
  image.spacing_mm = {1, 1, 1};
  for (int k = 0; k < 48; ++k) {
    for (int j = 0; j < 48; ++j) {
      for (int i = 0; i < 48; ++i) {
        const double r = std::hypot(i - 23.5, j - 23.5, k - 23.5);
        image.voxels.push_back(r < 10 ? 2 : r < 20 ? 1 : 0);
      }
    }
  }
  image.names[1] = {"shell", anatomesh::Colour{230, 200, 80}};
  image.names[2] = {"core", anatomesh::Colour{200, 60, 60}};

  anatomesh::Options options;
  options.deform.min_dihedral_deg = 20;
  const anatomesh::Result result = anatomesh::image_to_mesh(image, options);

  const anatomesh::Assessment good = anatomesh::assess(result.mesh, &image);
  std::printf("%zu tetrahedra, smallest dihedral angle %.1f degrees\n", result.mesh.tets.size(),
              good.whole.quality.min_dihedral_deg);
  for (const anatomesh::TissueOutcome& tissue : result.tissues) {
    std::printf("%s: %zu tetrahedra, F1 %.3f, F2 %.3f\n", result.mesh.names.at(tissue.label).name.c_str(),
                static_cast<std::size_t>(tissue.tets), tissue.f1, tissue.f2);
  }
  return good.whole.quality.min_dihedral_deg >= 20 ? 0 : 1;
}
