#ifndef itkLabelImageToTetrahedralMeshFilter_hxx
#define itkLabelImageToTetrahedralMeshFilter_hxx

#include <anatomesh/errors.h>

#include <limits>
#include <stop_token>
#include <string_view>
#include <utility>

#include "itkImageRegionConstIterator.h"
#include "itkTetrahedronCell.h"

namespace itk {

template <typename TInputImage, typename TOutputMesh>
LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::LabelImageToTetrahedralMeshFilter() {
  this->SetNumberOfRequiredInputs(1);
}

template <typename TInputImage, typename TOutputMesh>
void LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::SetInput(const InputImageType* image) {
  this->ProcessObject::SetNthInput(0, const_cast<InputImageType*>(image));
}

template <typename TInputImage, typename TOutputMesh>
const TInputImage* LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::GetInput() const {
  return itkDynamicCastInDebugMode<const TInputImage*>(this->GetPrimaryInput());
}

template <typename TInputImage, typename TOutputMesh>
void LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::SetOptions(const anatomesh::Options& options) {
  m_Options = options;
  this->Modified();
}

// A tissue is meshed as a whole.
template <typename TInputImage, typename TOutputMesh>
void LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::GenerateInputRequestedRegion() {
  Superclass::GenerateInputRequestedRegion();
  if (auto* image = const_cast<InputImageType*>(this->GetInput())) image->SetRequestedRegionToLargestPossibleRegion();
}

template <typename TInputImage, typename TOutputMesh>
anatomesh::LabelImage LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::LabelImageOfInput() const {
  const InputImageType* input = this->GetInput();
  const auto region = input->GetLargestPossibleRegion();
  typename InputImageType::PointType origin;
  input->TransformIndexToPhysicalPoint(region.GetIndex(), origin);
  anatomesh::LabelImage image;
  for (unsigned int a = 0; a < 3; ++a) {
    image.size[a] = region.GetSize(a);
    image.spacing_mm[a] = input->GetSpacing()[a];
    image.origin_mm[a] = origin[a];
    for (unsigned int b = 0; b < 3; ++b) image.direction[a][b] = input->GetDirection()(a, b);
  }
  image.voxels.reserve(region.GetNumberOfPixels());
  for (ImageRegionConstIterator<InputImageType> it(input, region); !it.IsAtEnd(); ++it) {
    const auto value = it.Get();
    if (!std::in_range<LabelType>(value)) {
      itkExceptionMacro("the voxel at " << it.GetIndex() << " has the value " << +value << "; labels must be from 0 to "
                                        << std::numeric_limits<LabelType>::max());
    }
    image.voxels.push_back(static_cast<LabelType>(value));
  }
  return image;
}

template <typename TInputImage, typename TOutputMesh>
anatomesh::Result LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::MeshOf(
    const anatomesh::LabelImage& image) {
  std::stop_source stop;
  anatomesh::Options options = m_Options;
  options.frame = anatomesh::Frame::lps;
  const anatomesh::Progress progress = {[&](std::string_view, double done) {
                                          this->UpdateProgress(static_cast<float>(done));
                                          if (this->GetAbortGenerateData()) stop.request_stop();
                                        },
                                        stop.get_token()};
  try {
    return anatomesh::image_to_mesh(image, options, progress);
  } catch (const anatomesh::Cancelled&) {
    ProcessAborted aborted(__FILE__, __LINE__);
    aborted.SetDescription("AbortGenerateData was set");
    aborted.SetLocation(ITK_LOCATION);
    throw aborted;
  } catch (const anatomesh::Error& error) {
    itkExceptionMacro(<< error.what());
  }
}

template <typename TInputImage, typename TOutputMesh>
void LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::FillOutput(const anatomesh::TetMesh& mesh) {
  using CellType = typename OutputMeshType::CellType;
  using TetrahedronType = TetrahedronCell<CellType>;
  OutputMeshType* output = this->GetOutput();
  auto points = OutputMeshType::PointsContainer::New();
  points->Reserve(mesh.points_mm.size());
  for (std::size_t v = 0; v < mesh.points_mm.size(); ++v) {
    typename OutputMeshType::PointType point;
    for (unsigned int a = 0; a < 3; ++a)
      point[a] = static_cast<typename OutputMeshType::CoordRepType>(mesh.points_mm[v][a]);
    points->SetElement(v, point);
  }
  output->SetPoints(points);
  auto labels = OutputMeshType::CellDataContainer::New();
  labels->Reserve(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    typename OutputMeshType::CellAutoPointer cell;
    cell.TakeOwnership(new TetrahedronType);
    for (unsigned int c = 0; c < 4; ++c) cell->SetPointId(static_cast<int>(c), mesh.tets[t][c]);
    output->SetCell(t, cell);
    labels->SetElement(t, static_cast<typename OutputMeshType::CellPixelType>(mesh.labels[t]));
  }
  output->SetCellData(labels);
  output->SetBufferedRegion(output->GetRequestedRegion());  // or the next Update() would run again
}

template <typename TInputImage, typename TOutputMesh>
void LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::GenerateData() {
  anatomesh::Result result = this->MeshOf(this->LabelImageOfInput());
  for (const std::string& warning : result.warnings) itkWarningMacro(<< warning);
  this->FillOutput(result.mesh);
  m_Tissues = std::move(result.tissues);
}

template <typename TInputImage, typename TOutputMesh>
void LabelImageToTetrahedralMeshFilter<TInputImage, TOutputMesh>::PrintSelf(std::ostream& os, Indent indent) const {
  Superclass::PrintSelf(os, indent);
  os << indent << "BccSize: " << this->GetBccSize() << std::endl;
  os << indent << "MinSize: " << this->GetMinSize() << std::endl;
  os << indent << "Fidelity: " << this->GetFidelity() << std::endl;
  os << indent << "MaxElements: " << this->GetMaxElements() << std::endl;
  os << indent << "MinDihedral: " << this->GetMinDihedral() << std::endl;
  os << indent << "MaxDihedral: " << this->GetMaxDihedral() << std::endl;
  os << indent << "Labels: " << m_Options.labels.size() << std::endl;
}

}  // namespace itk

#endif
