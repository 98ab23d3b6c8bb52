// The options of the mesher as Data of a component.
#pragma once

#include <Anatomesh/config.h>
#include <sofa/core/objectmodel/BaseObject.h>
#include <sofa/type/vector.h>

#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/mesh_request.h"

namespace anatomesh::simulation {

/// Every option of `anatomesh mesh`, under its name with camelCase for hyphens: --bcc-size is bccSize. Materials are
/// Data of the component itself.
struct SOFA_ANATOMESH_API MeshOptions {
  template <class Value>
  using Data = sofa::core::objectmodel::Data<Value>;
  using Texts = sofa::type::vector<std::string>;

  Data<double> d_bccSize, d_minSize, d_fidelity;
  Data<Texts> d_fidelityLabel;
  Data<std::string> d_fidelityStage;
  Data<long> d_maxElements;
  Data<Texts> d_sizeLabel;
  Data<int> d_elementsAcross;
  Data<long> d_dropIslands;
  Data<bool> d_allowNonManifold;
  Data<std::string> d_nonConnectivity;
  Data<int> d_iterations;
  Data<double> d_gradation, d_minDihedral, d_maxDihedral, d_minMeanRatio;
  Data<std::string> d_labels, d_frame;
  Data<int> d_threads;
  Data<double> d_maxMemory;

  /// The Data belong to the component.
  explicit MeshOptions(sofa::core::objectmodel::BaseObject& component);

  std::vector<sofa::core::objectmodel::BaseData*> all();

  /// What they ask for. Throws InvalidOption.
  MeshRequest request() const;
};

/// Calls `add` with each text of the Data; what is wrong with it is told with the Data's name. Throws InvalidOption.
void add_each(const sofa::core::objectmodel::Data<sofa::type::vector<std::string>>& data, MeshRequest& request,
              void (*add)(MeshRequest&, std::string_view));

/// Names such as "min_dihedral_deg" in a message of the library, replaced by those of the Data, "minDihedral".
SOFA_ANATOMESH_API std::string with_data_names(std::string_view message);

}  // namespace anatomesh::simulation
