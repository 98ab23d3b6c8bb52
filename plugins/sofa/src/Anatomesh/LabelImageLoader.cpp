#include <Anatomesh/LabelImageLoader.h>
#include <sofa/core/ObjectFactory.h>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "anatomesh/quadratic.h"

namespace anatomesh::simulation {

LabelImageLoader::LabelImageLoader()
    : d_filename(initData(&d_filename, "filename", "mesh of labelled tetrahedra: .vtu, .msh, .mesh, ...")) {
  addInput(&d_filename);
}

TetMesh LabelImageLoader::makeMesh() {
  if (d_filename.getValue().empty()) throw InvalidInput("filename is empty; it must name a mesh file");
  const TetMesh mesh = linear_mesh(read_mesh(d_filename.getFullPath()));  // force fields take linear ones
  msg_info() << mesh.tets.size() << " tetrahedra, " << mesh.points_mm.size() << " vertices";
  return mesh;
}

void registerLabelImageLoader(sofa::core::ObjectFactory* factory) {
  factory->registerObjects(
      sofa::core::ObjectRegistrationData("Labelled tetrahedral mesh of a file, with its surfaces, its interfaces and "
                                         "the materials of its tetrahedra.")
          .add<LabelImageLoader>());
}

}  // namespace anatomesh::simulation
