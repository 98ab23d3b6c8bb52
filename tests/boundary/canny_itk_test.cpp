// Our edge points against ITK's Canny filter on the smoothed binary image.
#include <gtest/gtest.h>
#include <itkCannyEdgeDetectionImageFilter.h>
#include <itkImage.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/vec.h"
#include "boundary/edge_points.h"
#include "shapes.h"

namespace anatomesh {
namespace {

using Voxels = std::set<std::array<int, 3>>;
using Image = itk::Image<float, 3>;

// Edge voxels by ITK, with a Gaussian of the variance of the cubic B-spline (a third of a squared voxel).
Voxels itk_edges(const TissueImage& tissues) {
  const auto image = Image::New();
  Image::SizeType size;
  Image::SpacingType spacing;
  for (unsigned a = 0; a < 3; ++a) {
    size[a] = static_cast<itk::SizeValueType>(tissues.size[a]);
    spacing[a] = tissues.spacing_mm[a];
  }
  image->SetRegions(size);
  image->SetSpacing(spacing);
  image->Allocate();
  std::transform(tissues.voxels.begin(), tissues.voxels.end(), image->GetBufferPointer(),
                 [](TissueId t) { return static_cast<float>(t); });

  const auto canny = itk::CannyEdgeDetectionImageFilter<Image, Image>::New();
  canny->SetInput(image);
  auto variance = canny->GetVariance();
  for (unsigned a = 0; a < 3; ++a) variance[a] = spacing[a] * spacing[a] / 3;
  canny->SetVariance(variance);
  canny->SetUpperThreshold(0.2f);
  canny->SetLowerThreshold(0.1f);
  canny->Update();

  Voxels edges;
  const float* value = canny->GetOutput()->GetBufferPointer();
  for (int k = 0; k < tissues.size[2]; ++k) {
    for (int j = 0; j < tissues.size[1]; ++j) {
      for (int i = 0; i < tissues.size[0]; ++i) {
        if (*value++ > 0) edges.insert({i, j, k});
      }
    }
  }
  return edges;
}

Voxels our_edges(const TissueImage& tissues) {
  Voxels edges;
  for (const EdgePoint& p : find_edge_points(tissues)) edges.insert(p.voxel);
  return edges;
}

// Share of `from` that has a voxel of `to` in the same place or at a face, edge or vertex.
double share_near(const Voxels& from, const Voxels& to) {
  std::size_t near = 0;
  for (const auto& v : from) {
    bool found = false;
    for (int n = 0; n < 27 && !found; ++n)
      found = to.contains({v[0] + n % 3 - 1, v[1] + n / 3 % 3 - 1, v[2] + n / 9 - 1});
    near += found ? 1 : 0;
  }
  return static_cast<double>(near) / static_cast<double>(from.size());
}

void expect_the_same_edges(const TissueImage& tissues) {
  const Voxels itk = itk_edges(tissues), ours = our_edges(tissues);
  EXPECT_GT(itk.size(), 500u);
  EXPECT_GT(ours.size(), 500u);
  EXPECT_GE(share_near(itk, ours), 0.99);
  EXPECT_GE(share_near(ours, itk), 0.99);
}

TEST(CannyItk, Sphere) {
  expect_the_same_edges(testing::tissues_of(32, {1, 1, 1}, [](Vec3 p) {
    return static_cast<Label>(norm(p - Vec3{15.6, 16.2, 15.9}) < 10.3);
  }));
}

TEST(CannyItk, Cube) {
  expect_the_same_edges(testing::tissues_of(30, {1, 1, 1}, [](Vec3 p) {
    const auto inside = [](double x) { return x > 7 && x < 21; };
    return static_cast<Label>(inside(p.x) && inside(p.y) && inside(p.z));
  }));
}

TEST(CannyItk, ThinPlate) {
  expect_the_same_edges(testing::tissues_of(30, {1, 1, 1}, [](Vec3 p) {
    const double height = p.z - 0.3 * p.x - 0.1 * p.y;
    return static_cast<Label>(height > 6 && height < 8.5);
  }));
}

TEST(CannyItk, AnisotropicSphere) {
  expect_the_same_edges(testing::tissues_of(32, {0.7, 1, 1.6}, [](Vec3 p) {
    return static_cast<Label>(norm(p - Vec3{11, 16, 25}) < 9.2);
  }));
}

}  // namespace
}  // namespace anatomesh
