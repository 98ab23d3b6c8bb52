// Elastic properties of tissues.
#pragma once

#include "anatomesh/options.h"

namespace anatomesh {

/// What a tissue is, as far as its stiffness goes.
enum class TissueKind { brain, ventricle, tumour, vessel, other };

/// Values of the literature (sources in materials.cpp) for a linear-elastic model of small, slow deformations.
Material default_material(TissueKind kind);

}  // namespace anatomesh
