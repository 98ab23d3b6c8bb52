// What SOFA asks a plugin for when it loads it.
#include <Anatomesh/config.h>
#include <sofa/core/ObjectFactory.h>

namespace anatomesh::simulation {

extern void registerImageToTetrahedralMesh(sofa::core::ObjectFactory* factory);
extern void registerLabelImageLoader(sofa::core::ObjectFactory* factory);

extern "C" {

SOFA_ANATOMESH_API void initExternalModule() {}

SOFA_ANATOMESH_API const char* getModuleName() { return MODULE_NAME; }

SOFA_ANATOMESH_API const char* getModuleVersion() { return MODULE_VERSION; }

SOFA_ANATOMESH_API const char* getModuleLicense() { return "see LICENSE"; }

SOFA_ANATOMESH_API const char* getModuleDescription() { return "Tetrahedral meshes of segmented medical images"; }

SOFA_ANATOMESH_API void registerObjects(sofa::core::ObjectFactory* factory) {
  registerImageToTetrahedralMesh(factory);
  registerLabelImageLoader(factory);
}
}

}  // namespace anatomesh::simulation
