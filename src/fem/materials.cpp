// Values of linear-elastic models of the brain. Measurements differ by more than an order of magnitude between
// methods and authors; the registration needs no more than their order. A wide collection is A. Granados et al., "A
// generative model of hyperelastic strain energy density functions for multiple tissue brain deformation",
// International Journal of Computer Assisted Radiology and Surgery 16, 2021.
#include "anatomesh/materials.h"

namespace anatomesh {

Material default_material(TissueKind kind) {
  switch (kind) {
    // M. Ferrant et al., "Registration of 3-D intraoperative MR images of the brain using a finite-element
    // biomechanical model", IEEE Transactions on Medical Imaging 20(12), 2001; the same in L. M. Vigneron et al.,
    // "Serial FEM/XFEM-based update of preoperative brain images using intraoperative MRI", International Journal of
    // Biomedical Imaging, 2012. (O. Clatz et al., IEEE Transactions on Medical Imaging 24(11), 2005: 694 Pa, 0.45.)
    case TissueKind::brain:
      return {.young_modulus_pa = 3000, .poisson_ratio = 0.45};
    // Cerebrospinal fluid as a very soft, compressible solid: A. Wittek, K. Miller, R. Kikinis, S. K. Warfield,
    // "Patient-specific model of brain deformation: application to medical image registration", Journal of
    // Biomechanics 40(4), 2007. (M. Bucki et al., "Doppler ultrasound driven biomechanical model of the brain for
    // intraoperative brain-shift compensation", Springer, 2012: 10 Pa, 0.05.)
    case TissueKind::ventricle:
      return {.young_modulus_pa = 10, .poisson_ratio = 0.1};
    // Three times the brain: K. Miller, J. Lu, "On the prospect of patient-specific biomechanics without
    // patient-specific properties of tissues", Journal of the Mechanical Behavior of Biomedical Materials 27, 2013.
    case TissueKind::tumour:
      return {.young_modulus_pa = 9000, .poisson_ratio = 0.45};
    // The wall of cerebral arteries has about 1 MPa and 0.45 (R. Torii et al., "Fluid-structure interaction modeling
    // of aneurysmal conditions with high and normal blood pressures", Computational Mechanics 38, 2006). A vessel is
    // meshed with its blood: times the wall's share of the cross-section, about 0.3 (our estimate).
    case TissueKind::vessel:
      return {.young_modulus_pa = 300000, .poisson_ratio = 0.45};
    case TissueKind::other:
      break;
  }
  return {};  // the default of the options: as brain
}

}  // namespace anatomesh
