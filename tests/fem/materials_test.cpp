#include "anatomesh/materials.h"

#include <gtest/gtest.h>

namespace anatomesh {
namespace {

TEST(Materials, AreAdmissible) {
  for (const TissueKind kind :
       {TissueKind::brain, TissueKind::ventricle, TissueKind::tumour, TissueKind::vessel, TissueKind::other}) {
    const Material material = default_material(kind);
    EXPECT_GT(material.young_modulus_pa, 0);
    EXPECT_GE(material.poisson_ratio, 0);
    EXPECT_LT(material.poisson_ratio, 0.5);
  }
}

TEST(Materials, AreOrderedByStiffness) {
  const auto stiffness = [](TissueKind kind) { return default_material(kind).young_modulus_pa; };
  EXPECT_LT(stiffness(TissueKind::ventricle), stiffness(TissueKind::brain));
  EXPECT_LT(stiffness(TissueKind::brain), stiffness(TissueKind::tumour));
  EXPECT_LT(stiffness(TissueKind::tumour), stiffness(TissueKind::vessel));
}

TEST(Materials, OtherTissuesTakeTheDefaultOfTheOptions) {
  const Material other = default_material(TissueKind::other), of_options = DeformOptions{}.default_material;
  EXPECT_EQ(other.young_modulus_pa, of_options.young_modulus_pa);
  EXPECT_EQ(other.poisson_ratio, of_options.poisson_ratio);
}

}  // namespace
}  // namespace anatomesh
