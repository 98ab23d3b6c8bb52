// XDMF of other tools.
#include <string>
#include <vector>

#include "io/mesh_file_fixture.h"

namespace anatomesh::testing {
namespace {

class Xdmf : public NamedMeshFileTest {
 protected:
  Xdmf() : NamedMeshFileTest("mesh.xdmf") {}
};

TetMesh two_tissues() {
  TetMesh mesh = two_uneven_tets(7, 4294967295U);
  mesh.names[7] = {"Left \"ventricle\" <3 & ]]> co", Colour{255, 0, 17}};
  mesh.names[9] = {"Große Vene", {}};
  return mesh;
}

std::string item(const std::string& attributes, const std::string& values) {
  return "<DataItem Format=\"XML\" " + attributes + ">" + values + "</DataItem>";
}

const std::string kPoints =
    "<Geometry GeometryType=\"XYZ\">" + item("Dimensions=\"4 3\"", "0 0 0 1 0 0 0 1 0 0 0 1.5") + "</Geometry>";
const std::string kOneTet = "<Topology TopologyType=\"Tetrahedron\" NumberOfElements=\"1\">" +
                            item("NumberType=\"Int\" Dimensions=\"1 4\"", "0 1 2 3") + "</Topology>";

std::string grid(const std::string& inside) { return "<Grid Name=\"Grid\">" + inside + "</Grid>"; }

std::string file(const std::string& grids) {
  return "<?xml version=\"1.0\"?><Xdmf Version=\"3.0\" xmlns:xi=\"http://www.w3.org/2001/XInclude\"><Domain>" + grids +
         "</Domain></Xdmf>";
}

std::string cell_attribute(const std::string& name, const std::string& type, const std::string& value) {
  return "<Attribute Name=\"" + name + "\" Center=\"Cell\">" +
         item("NumberType=\"" + type + "\" Dimensions=\"1\"", value) + "</Attribute>";
}

TEST_F(Xdmf, FourFilesThatBelongTogether) {
  write_mesh(in_folder("brain.xdmf"), two_tissues());
  EXPECT_EQ(folder_listing(), "brain.h5 brain.xdmf brain_facets.h5 brain_facets.xdmf");
  const std::string tets = bytes_of(in_folder("brain.xdmf")), facets = bytes_of(in_folder("brain_facets.xdmf"));
  EXPECT_SAYS(tets, "brain.h5:/mesh/tetrahedra");
  EXPECT_SAYS(facets, "brain.h5:/mesh/points");
  EXPECT_SAYS(facets, "brain_facets.h5:/facets/interface");
  EXPECT_SAYS(
      message_of<InvalidInput>(in_folder("brain_facets.xdmf"), [&] { read_mesh(in_folder("brain_facets.xdmf")); }),
      "no tetrahedra of 4 or 10 nodes");
}

TEST_F(Xdmf, HdfFilesAreDeterministic) {
  write_mesh(in_folder("mesh.xdmf"), two_tissues());
  const std::string first = bytes_of(in_folder("mesh.h5")), facets = bytes_of(in_folder("mesh_facets.h5"));
  write_mesh(in_folder("mesh.xdmf"), two_tissues());
  EXPECT_EQ(bytes_of(in_folder("mesh.h5")), first);
  EXPECT_EQ(bytes_of(in_folder("mesh_facets.h5")), facets);
}

TEST_F(Xdmf, AllFilesOrNone) {
  put("mesh.h5", "earlier");
  std::filesystem::create_directory(in_folder("mesh_facets.xdmf"));
  EXPECT_SAYS(
      message_of<IoError>(in_folder("mesh_facets.xdmf"), [&] { write_mesh(in_folder("mesh.xdmf"), two_tissues()); }),
      "it is a folder");
  EXPECT_EQ(folder_listing(), "mesh.h5 mesh_facets.xdmf");
  EXPECT_EQ(bytes_of(in_folder("mesh.h5")), "earlier");
}

TEST_F(Xdmf, InlineNumbers) {
  const TetMesh mesh = read(file(grid(kPoints + kOneTet + cell_attribute("medit:ref", "Int", "5"))));
  ASSERT_EQ(mesh.tets.size(), 1U);
  EXPECT_EQ(mesh.points_mm[3], (Vec3{0, 0, 1.5}));
  EXPECT_EQ(mesh.labels[0], 5U);
  EXPECT_EQ(read(file(grid(kPoints + kOneTet))).labels[0], 1U);
}

TEST_F(Xdmf, MixedCells) {
  const std::string mixed = "<Topology Type=\"Mixed\">" +
                            item("DataType=\"Int\" Dimensions=\"13\"", "4 0 1 2 2 2 0 1 6 0 1 2 3") + "</Topology>";
  const std::string labels = "<Attribute Name=\"label\" Center=\"Cell\">" +
                             item("DataType=\"Int\" Dimensions=\"3\"", "1 2 3") + "</Attribute>";
  const TetMesh mesh = read(file(grid(mixed + kPoints + labels)));
  EXPECT_EQ(mesh.tets, (std::vector<std::array<VertexId, 4>>{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.labels[0], 3U);
}

// As DOLFINx writes the tags of cells: in a second grid, which includes the geometry of the first.
TEST_F(Xdmf, TagsInAGridOfTheirOwn) {
  const std::string included = "<xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid/Geometry)\"/>";
  const TetMesh mesh =
      read(file(grid(kPoints + kOneTet) + grid(included + kOneTet + cell_attribute("tags", "UInt", "8"))));
  EXPECT_EQ(mesh.labels[0], 8U);
  EXPECT_EQ(mesh.points_mm.size(), 4U);
}

TEST_F(Xdmf, DamagedTextIsRefused) {
  struct Case {
    std::string text;
    const char* says;
  };
  const auto topology = [](const std::string& dimensions, const std::string& values) {
    return file(grid(kPoints + "<Topology TopologyType=\"Tetrahedron\">" +
                     item("NumberType=\"Int\" Dimensions=\"" + dimensions + "\"", values) + "</Topology>"));
  };
  const std::vector<Case> cases = {{"no XML", "byte"},
                                   {"<Other/>", "Xdmf"},
                                   {topology("1 4", "0 1 2 4"), "point 4"},
                                   {topology("1 4", "0 1 2 -1"), "point -1"},
                                   {topology("1 4", "0 1 2"), "fewer numbers"},
                                   {topology("1 4", "0 1 2 3 0"), "5 numbers, not 4"},
                                   {topology("1 4", "0 1 2 x"), "'x'"},
                                   {topology("1 3", "0 1 2"), "3 nodes"},
                                   {topology("99999999 99999999", "0 1 2 3"), "dimensions"},
                                   {topology("10000000 4", "0 1 2 3"), "fewer numbers"},
                                   {topology("", "0 1 2 3"), "no dimensions"},
                                   {file(grid(kPoints + "<Topology Type=\"Tetrahedron\"/>")), "no DataItem"},
                                   {file(grid(kOneTet)), "no DataItem"}};
  for (const Case& c : cases) EXPECT_SAYS(refused<IoError>(c.text), c.says);
  EXPECT_SAYS(refused<InvalidInput>(file(grid(kPoints))), "no tetrahedra of 4 or 10 nodes");
  EXPECT_SAYS(refused<InvalidInput>(file(grid(kPoints + kOneTet + cell_attribute("label", "Float", "1.5")))), "1.5");
}

TEST_F(Xdmf, MissingDataAreRefused) {
  const std::string text = written(two_tissues());
  const auto with = [&](const std::string& part, const std::string& instead) {
    std::string changed = text;
    changed.replace(changed.find(part), part.size(), instead);
    return changed;
  };
  const auto said = [&](const std::string& changed, const char* named) {
    put("mesh.xdmf", changed);
    return message_of<IoError>(named, [&] { read_mesh(in_folder("mesh.xdmf")); });
  };
  EXPECT_SAYS(said(with("mesh.h5:", "gone.h5:"), "gone.h5"), "there is no file");
  EXPECT_SAYS(said(with("/mesh/tetrahedra", "/mesh/hexahedra"), "mesh.h5"), "'/mesh/hexahedra' cannot be opened");
  EXPECT_SAYS(said(with("/mesh/tetrahedra", "/mesh"), "mesh.h5"), "cannot be opened");
  EXPECT_SAYS(said(with("/mesh/tetrahedra", "/mesh/points"), "mesh.h5"), "reals where integers");
  EXPECT_SAYS(said(with("/mesh/tetrahedra", "/labels/names"), "mesh.h5"), "holds no numbers");
  EXPECT_SAYS(said(with("\"2 4\"", "\"3 4\""), "mesh.h5"), "8 numbers where 12 are expected");
  EXPECT_SAYS(said(with("mesh.h5:/mesh/tetrahedra", "tetrahedra"), "mesh.xdmf"), "names no dataset");
  put("mesh.h5", "no HDF5");
  EXPECT_SAYS(said(text, "mesh.h5"), "it is no HDF5 file");
}

}  // namespace
}  // namespace anatomesh::testing
