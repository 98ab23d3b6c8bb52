#include <Anatomesh/LabelImageLoader.h>
#include <gtest/gtest.h>

#include "anatomesh/image_to_mesh.h"
#include "anatomesh/io.h"
#include "sofa_session.h"

namespace anatomesh::simulation {
namespace {

TEST(LabelImageLoader, HasTheOutputsOfTheMesher) {
  const TemporaryFolder folder;
  Options options;
  options.deform.material[7] = {9000, 0.45};
  const TetMesh mesh = image_to_mesh(two_balls(), options).mesh;
  const auto mesher = mesher_of(two_balls());
  set(*mesher, "young", "7=9000");
  mesher->init();
  for (const char* name : {"mesh.vtu", "mesh.msh"}) {
    write_mesh(folder.path() / name, mesh);
    const auto loader = sofa::core::objectmodel::New<LabelImageLoader>();
    set(*loader, "filename", (folder.path() / name).string());
    set(*loader, "young", "7=9000");
    loader->init();
    ASSERT_TRUE(is_valid(*loader)) << errors_of(*loader);
    EXPECT_EQ(loader->d_tetrahedra.getValue().size(), mesh.tets.size());
    EXPECT_EQ(loader->d_triangles.getValue().size(), mesher->d_triangles.getValue().size());
    EXPECT_EQ(loader->d_interfaceTriangles.getValue().size(), mesher->d_interfaceTriangles.getValue().size());
    EXPECT_EQ(loader->d_tissueLabels.getValue(), mesher->d_tissueLabels.getValue());
    EXPECT_EQ(loader->d_poissonRatio.getValue(), mesher->d_poissonRatio.getValue());
    EXPECT_EQ(loader->d_position.getValue().size(), mesher->d_position.getValue().size());
  }
}

TEST(LabelImageLoader, BadFilesLeaveAMessage) {
  start_sofa();
  for (const std::string name : {"", "/nowhere/mesh.vtu", "/nowhere/mesh.abc"}) {
    const auto loader = sofa::core::objectmodel::New<LabelImageLoader>();
    set(*loader, "filename", name);
    loader->init();
    EXPECT_FALSE(is_valid(*loader));
    EXPECT_NE(errors_of(*loader).find(name.empty() ? "filename is empty" : name), std::string::npos)
        << errors_of(*loader);
  }
}

}  // namespace
}  // namespace anatomesh::simulation
