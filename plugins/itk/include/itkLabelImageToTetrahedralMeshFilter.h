// An ITK filter around anatomesh::image_to_mesh().
#ifndef itkLabelImageToTetrahedralMeshFilter_h
#define itkLabelImageToTetrahedralMeshFilter_h

#include <anatomesh/image_to_mesh.h>

#include <string>
#include <vector>

#include "itkDefaultStaticMeshTraits.h"
#include "itkImageToMeshFilter.h"
#include "itkMesh.h"

namespace itk {

/** The mesh that the filter makes unless asked for another: points in double, one label as the data of every cell. */
using LabelledTetrahedralMesh =
    Mesh<unsigned int, 3, DefaultStaticMeshTraits<unsigned int, 3, 3, double, double, unsigned int>>;

/** \class LabelImageToTetrahedralMeshFilter
 * \brief Turns a label image into a conforming mesh of tetrahedra, with the labels as cell data.
 *
 * The input is a 3D image of integers, 0 being background. The output lies in the image's physical space. Options keep
 * the names, units and defaults of the Anatomesh command line; SetOptions() takes all of them at once. The whole image
 * is asked for, whatever region is requested. Progress is reported and AbortGenerateData is obeyed, within about a
 * tenth of a second.
 *
 * Method: F. Drakopoulos and N. Chrisochoides, "Tetrahedral Image-To-Mesh Conversion for Anatomical Modeling and
 * Surgical Simulations".
 */
template <typename TInputImage, typename TOutputMesh = LabelledTetrahedralMesh>
class ITK_TEMPLATE_EXPORT LabelImageToTetrahedralMeshFilter : public ImageToMeshFilter<TInputImage, TOutputMesh> {
 public:
  ITK_DISALLOW_COPY_AND_MOVE(LabelImageToTetrahedralMeshFilter);

  using Self = LabelImageToTetrahedralMeshFilter;
  using Superclass = ImageToMeshFilter<TInputImage, TOutputMesh>;
  using Pointer = SmartPointer<Self>;
  using ConstPointer = SmartPointer<const Self>;
  using InputImageType = TInputImage;
  using OutputMeshType = TOutputMesh;
  using LabelType = anatomesh::Label;

  static_assert(TInputImage::ImageDimension == 3, "a label image of three dimensions is needed");
  static_assert(std::is_integral_v<typename TInputImage::PixelType>, "labels are integers");

  // clang-format off
  itkNewMacro(Self)
  itkTypeMacro(LabelImageToTetrahedralMeshFilter, ImageToMeshFilter);
  // clang-format on

  using Superclass::SetInput;
  void SetInput(const InputImageType* image);
  const InputImageType* GetInput() const;

  /** All options at once. */
  void SetOptions(const anatomesh::Options& options);
  const anatomesh::Options& GetOptions() const { return m_Options; }

  /** Spacing of the coarsest lattice in mm; 0: chosen from the image. */
  void SetBccSize(double millimetres) { this->Change(m_Options.lattice.bcc_size_mm, millimetres); }
  double GetBccSize() const { return m_Options.lattice.bcc_size_mm; }
  /** Smallest spacing of the lattice in mm; 0: chosen from the image. */
  void SetMinSize(double millimetres) { this->Change(m_Options.lattice.min_size_mm, millimetres); }
  double GetMinSize() const { return m_Options.lattice.min_size_mm; }
  /** F of all tissues, above 0 and at most 1. */
  void SetFidelity(double fidelity) { this->Change(m_Options.lattice.fidelity, fidelity); }
  double GetFidelity() const { return m_Options.lattice.fidelity; }
  /** F of one tissue in place of the above. */
  void SetFidelityOfLabel(LabelType label, double fidelity) {
    this->Change(m_Options.lattice.fidelity_label[label], fidelity);
  }
  /** Most tetrahedra; 0: as many as the fidelity takes. */
  void SetMaxElements(SizeValueType count) { this->Change(m_Options.lattice.max_elements, std::uint64_t{count}); }
  SizeValueType GetMaxElements() const { return m_Options.lattice.max_elements; }
  /** Bounds of the dihedral angles in degrees. */
  void SetMinDihedral(double degrees) { this->Change(m_Options.deform.min_dihedral_deg, degrees); }
  double GetMinDihedral() const { return m_Options.deform.min_dihedral_deg; }
  void SetMaxDihedral(double degrees) { this->Change(m_Options.deform.max_dihedral_deg, degrees); }
  double GetMaxDihedral() const { return m_Options.deform.max_dihedral_deg; }
  /** Labels to mesh; the rest is background. Empty: all. */
  void SetLabels(const std::vector<LabelType>& labels) { this->Change(m_Options.labels, labels); }
  const std::vector<LabelType>& GetLabels() const { return m_Options.labels; }

  /** After Update(): what became of every tissue, by ascending label. */
  const std::vector<anatomesh::TissueOutcome>& GetTissues() const { return m_Tissues; }

 protected:
  LabelImageToTetrahedralMeshFilter();
  ~LabelImageToTetrahedralMeshFilter() override = default;

  void GenerateInputRequestedRegion() override;
  void GenerateData() override;
  void PrintSelf(std::ostream& os, Indent indent) const override;

 private:
  template <typename Value>
  void Change(Value& option, const Value& value) {
    if (option == value) return;
    option = value;
    this->Modified();
  }
  anatomesh::LabelImage LabelImageOfInput() const;
  anatomesh::Result MeshOf(const anatomesh::LabelImage& image);
  void FillOutput(const anatomesh::TetMesh& mesh);

  anatomesh::Options m_Options;
  std::vector<anatomesh::TissueOutcome> m_Tissues;
};

}  // namespace itk

#ifndef ITK_MANUAL_INSTANTIATION
#include "itkLabelImageToTetrahedralMeshFilter.hxx"
#endif

#endif
