#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "itkCommand.h"
#include "itkImageRegionIteratorWithIndex.h"
#include "itkLabelImageToTetrahedralMeshFilter.h"

namespace {

using ImageType = itk::Image<short, 3>;
using FilterType = itk::LabelImageToTetrahedralMeshFilter<ImageType>;

// A ball of label 1 with a core of label 7, oblique, anisotropic, and with indices that do not begin at 0.
ImageType::Pointer TwoBalls(int side = 32) {
  auto image = ImageType::New();
  ImageType::RegionType region({{-5, 3, 11}}, {{static_cast<unsigned>(side), static_cast<unsigned>(side), 20}});
  image->SetRegions(region);
  image->Allocate(true);
  const double spacing[3] = {1, 1, 1.6}, origin[3] = {10, -20, 30};
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  ImageType::DirectionType direction;
  const double c = std::cos(0.4), s = std::sin(0.4);
  direction.Fill(0);
  direction(0, 0) = c, direction(0, 1) = s, direction(1, 0) = -s, direction(1, 1) = c, direction(2, 2) = -1;
  image->SetDirection(direction);
  for (itk::ImageRegionIteratorWithIndex<ImageType> it(image, region); !it.IsAtEnd(); ++it) {
    double square = 0;
    for (unsigned a = 0; a < 3; ++a) {
      const double middle = 0.5 * (static_cast<double>(region.GetSize(a)) - 1);
      const double off = (static_cast<double>(it.GetIndex()[a] - region.GetIndex(a)) - middle) * spacing[a];
      square += off * off;
    }
    it.Set(square < 36 ? 7 : square < 144 ? 1 : 0);
  }
  return image;
}

using MeshType = FilterType::OutputMeshType;

// In cubic millimetres; every tetrahedron must have some.
double VolumeOf(const MeshType* mesh, unsigned label) {
  double volume = 0;
  for (auto cell = mesh->GetCells()->Begin(); cell != mesh->GetCells()->End(); ++cell) {
    if (mesh->GetCellData()->ElementAt(cell.Index()) != label) continue;
    const auto* ids = cell.Value()->GetPointIds();
    const auto p = [&](int n) { return mesh->GetPoint(ids[n]); };
    const auto u = p(1) - p(0), v = p(2) - p(0), w = p(3) - p(0);
    const double six = itk::CrossProduct(u, v) * w;
    EXPECT_GT(six, 0);
    volume += six / 6;
  }
  return volume;
}

TEST(LabelImageToTetrahedralMeshFilter, MeshLiesWhereTheImageDoes) {
  const auto image = TwoBalls();
  auto filter = FilterType::New();
  filter->SetInput(image);
  filter->Update();
  const MeshType* mesh = filter->GetOutput();
  std::map<short, double> voxels;
  for (itk::ImageRegionConstIterator<ImageType> it(image, image->GetLargestPossibleRegion()); !it.IsAtEnd(); ++it)
    voxels[it.Get()] += 1.6;
  for (const unsigned label : {1U, 7U}) EXPECT_NEAR(VolumeOf(mesh, label) / voxels[static_cast<short>(label)], 1, 0.03);
  std::size_t right = 0;
  for (auto cell = mesh->GetCells()->Begin(); cell != mesh->GetCells()->End(); ++cell) {
    itk::Point<double, 3> middle;
    middle.Fill(0);
    for (int n = 0; n < 4; ++n) {
      const auto p = mesh->GetPoint(cell.Value()->GetPointIds()[n]);
      for (unsigned a = 0; a < 3; ++a) middle[a] += p[a] / 4;
    }
    const auto index = image->TransformPhysicalPointToIndex(middle);
    ASSERT_TRUE(image->GetLargestPossibleRegion().IsInside(index));
    right += static_cast<unsigned>(image->GetPixel(index)) == mesh->GetCellData()->ElementAt(cell.Index());
  }
  EXPECT_GT(static_cast<double>(right) / static_cast<double>(mesh->GetNumberOfCells()), 0.9);
  EXPECT_EQ(filter->GetTissues().size(), 2u);
}

TEST(LabelImageToTetrahedralMeshFilter, IsWhatTheLibraryMakes) {
  auto filter = FilterType::New();
  filter->SetInput(TwoBalls());
  filter->SetBccSize(6);
  filter->SetMinDihedral(15);
  filter->SetLabels({7});
  filter->Update();
  std::set<unsigned> labels;
  for (const unsigned label : filter->GetOutput()->GetCellData()->CastToSTLConstContainer()) labels.insert(label);
  EXPECT_EQ(labels, std::set<unsigned>{7});
  EXPECT_EQ(filter->GetOptions().lattice.bcc_size_mm, 6);
}

TEST(LabelImageToTetrahedralMeshFilter, AsksForTheWholeImageWhateverIsRequested) {
  const auto image = TwoBalls();
  auto filter = FilterType::New();
  filter->SetInput(image);
  filter->Update();
  const auto cells = filter->GetOutput()->GetNumberOfCells();
  auto region = image->GetLargestPossibleRegion();
  region.SetSize(0, 4);
  image->SetRequestedRegion(region);
  filter->Modified();
  filter->Update();
  EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), cells);
}

TEST(LabelImageToTetrahedralMeshFilter, RunsAgainOnlyWhenSomethingChanged) {
  auto filter = FilterType::New();
  filter->SetInput(TwoBalls());
  int runs = 0;
  filter->AddObserver(itk::StartEvent(), [&](const itk::EventObject&) { ++runs; });
  filter->Update();
  filter->Update();
  filter->SetFidelity(filter->GetFidelity());
  filter->Update();
  EXPECT_EQ(runs, 1);
  filter->SetFidelity(0.9);
  filter->Update();
  EXPECT_EQ(runs, 2);
}

TEST(LabelImageToTetrahedralMeshFilter, ReportsProgress) {
  auto filter = FilterType::New();
  filter->SetInput(TwoBalls());
  std::vector<float> seen;
  filter->AddObserver(itk::ProgressEvent(), [&](const itk::EventObject&) { seen.push_back(filter->GetProgress()); });
  filter->Update();
  EXPECT_GT(seen.size(), 5u);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
}

TEST(LabelImageToTetrahedralMeshFilter, ObeysAbort) {
  auto filter = FilterType::New();
  filter->SetInput(TwoBalls());
  filter->AddObserver(itk::ProgressEvent(), [&](const itk::EventObject&) { filter->AbortGenerateDataOn(); });
  EXPECT_THROW(filter->Update(), itk::ProcessAborted);
}

TEST(LabelImageToTetrahedralMeshFilter, ErrorsAreExceptions) {
  auto filter = FilterType::New();
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  filter->SetInput(TwoBalls());
  filter->SetFidelity(2);
  EXPECT_THROW(filter->Update(), itk::ExceptionObject);
  const auto image = TwoBalls();
  image->SetPixel(image->GetLargestPossibleRegion().GetIndex(), -3);
  auto negative = FilterType::New();
  negative->SetInput(image);
  try {
    negative->Update();
    ADD_FAILURE() << "no exception";
  } catch (const itk::ExceptionObject& error) {
    EXPECT_NE(std::string(error.GetDescription()).find("-3"), std::string::npos) << error;
  }
}

}  // namespace
