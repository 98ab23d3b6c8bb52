// What the components that bring a labelled mesh into a scene share: their outputs, and the materials of its tissues.
#pragma once

#include <Anatomesh/config.h>
#include <sofa/core/DataEngine.h>
#include <sofa/core/topology/Topology.h>
#include <sofa/type/SVector.h>
#include <sofa/type/Vec.h>
#include <sofa/type/vector.h>

#include <string>

#include "anatomesh/mesh_request.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh::simulation {

/// An engine whose outputs are a labelled tetrahedral mesh. They are empty, and the component is Invalid with an error
/// message, where no mesh could be made.
class SOFA_ANATOMESH_API TetrahedralMeshEngine : public sofa::core::DataEngine {
 public:
  SOFA_ABSTRACT_CLASS(TetrahedralMeshEngine, sofa::core::DataEngine);

  using Tetrahedron = sofa::core::topology::Topology::Tetrahedron;
  using Triangle = sofa::core::topology::Topology::Triangle;
  using Index = sofa::Index;
  template <class Value>
  using Values = sofa::type::vector<Value>;

  // Inputs: materials, "LABEL=VALUE" or "VALUE" for all others.
  sofa::Data<Values<std::string>> d_tissue;
  sofa::Data<Values<std::string>> d_young;
  sofa::Data<Values<std::string>> d_poisson;

  // Outputs.
  sofa::Data<Values<sofa::type::Vec3>> d_position;
  sofa::Data<Values<Tetrahedron>> d_tetrahedra;
  sofa::Data<Values<Label>> d_label;
  sofa::Data<Values<Triangle>> d_triangles;
  sofa::Data<Values<Index>> d_surfacePoints;
  sofa::Data<Values<Triangle>> d_interfaceTriangles;
  sofa::Data<Values<sofa::type::Vec<2, Label>>> d_interfaceLabels;
  sofa::Data<Values<Label>> d_tissueLabels;
  sofa::Data<Values<sofa::type::SVector<Index>>> d_tetrahedraInLabel;
  sofa::Data<Values<SReal>> d_youngModulus;
  sofa::Data<Values<SReal>> d_poissonRatio;

  void init() override;
  void reinit() override;

 protected:
  TetrahedralMeshEngine();

  /// Reports what is left unsaid in messages of its own. May throw any exception.
  virtual TetMesh makeMesh() = 0;

  /// Reads tissue, young and poisson. Throws InvalidOption.
  void addMaterials(MeshRequest& request) const;

  void doUpdate() override;

 private:
  void setMesh(const TetMesh& mesh);
  void setSurfaces(const TetMesh& mesh);
  void setTissues(const TetMesh& mesh);
  void setMaterials(const TetMesh& mesh);
};

}  // namespace anatomesh::simulation
