// The component that reads a mesh made earlier.
#pragma once

#include <Anatomesh/TetrahedralMeshEngine.h>
#include <Anatomesh/config.h>
#include <sofa/core/objectmodel/DataFileName.h>

namespace anatomesh::simulation {

/// Reads a labelled mesh, with the outputs of ImageToTetrahedralMesh. Nothing is meshed when the scene starts.
class SOFA_ANATOMESH_API LabelImageLoader : public TetrahedralMeshEngine {
 public:
  SOFA_CLASS(LabelImageLoader, TetrahedralMeshEngine);

  sofa::core::objectmodel::DataFileName d_filename;

 protected:
  LabelImageLoader();

  TetMesh makeMesh() override;
};

}  // namespace anatomesh::simulation
