// What is special about VTK's XML files; what other programs write is in tests/tools/vtu_test.py.
#include <string>

#include "io/mesh_file_fixture.h"

namespace anatomesh::testing {
namespace {

class VtuFile : public NamedMeshFileTest {
 protected:
  VtuFile() : NamedMeshFileTest("mesh.vtu") {}
};

std::string file_of(const std::string& grid, const std::string& attributes = "byte_order=\"LittleEndian\"") {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" " + attributes +
         "><UnstructuredGrid>" + grid + "</UnstructuredGrid></VTKFile>";
}

std::string array(const std::string& type, const std::string& name, const std::string& values) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + values + "</DataArray>";
}

/// A tetrahedron whose corners are points 0 to 3 of the piece.
std::string piece(const std::string& corners = "0 1 2 3", const std::string& labels = array("Int32", "label", "7")) {
  return "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><CellData>" + labels +
         "</CellData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">"
         "0 0 0 1 0 0 0 +1e0 0 0 0 .5</DataArray></Points><Cells>" +
         array("Int64", "connectivity", corners) + array("Int64", "offsets", "4") + array("UInt8", "types", "10") +
         "</Cells></Piece>";
}

TEST_F(VtuFile, PiecesCountTheirPointsAnew) {
  const std::string empty = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"></Piece>";
  const TetMesh mesh = read(file_of(empty + piece() + piece("3 1 0 2", array("Int32", "label", "8"))));
  EXPECT_EQ(mesh.points_mm.size(), 8U);
  EXPECT_EQ(mesh.points_mm[7], (Vec3{0, 0, 0.5}));
  EXPECT_EQ(mesh.tets, (std::vector<std::array<VertexId, 4>>{{0, 1, 2, 3}, {7, 5, 4, 6}}));
  EXPECT_EQ(mesh.labels, (std::vector<Label>{7, 8}));
}

TEST_F(VtuFile, PiecesKeepToTheirPoints) {
  EXPECT_SAYS(refused<IoError>(file_of(piece("0 1 2 4") + piece())), "point 4 of 4");
  EXPECT_SAYS(refused<IoError>(file_of(piece() + piece("0 1 2 -1"))), "point -1");
}

TEST_F(VtuFile, PiecesHaveTheSameLabelArray) {
  EXPECT_SAYS(refused<IoError>(file_of(piece() + piece("0 1 2 3", ""))), "'label' is missing");
  EXPECT_SAYS(refused<IoError>(file_of(piece() + piece("0 1 2 3", array("Int8", "label", "7")))), "another type");
}

// Two arrays of the same base64 text, sizes and data encoded one after the other or together.
TEST_F(VtuFile, Base64) {
  const auto with_labels = [&](const std::string& text) {
    return file_of(
        piece("0 1 2 3", "<DataArray type=\"UInt32\" Name=\"label\" format=\"binary\">" + text + "</DataArray>"));
  };
  EXPECT_EQ(read(with_labels("BAAAAAkAAAA=")).labels, (std::vector<Label>{9}));
  EXPECT_EQ(read(with_labels("\n BAAAAA==CQAAAA==\n")).labels, (std::vector<Label>{9}));
  EXPECT_SAYS(refused<IoError>(with_labels("BQAAAAkAAAA=")), "'label' is cut off");
  EXPECT_SAYS(refused<IoError>(with_labels("BAAAAAkAAAA")), "is no base64");
  EXPECT_SAYS(refused<IoError>(with_labels("AwAAAAkAAAA=")), "ends within a number");
}

TEST_F(VtuFile, AppendedBigEndianRaw) {
  std::string text =
      file_of(piece("0 1 2 3", "<DataArray type=\"UInt16\" Name=\"label\" format=\"appended\" offset=\"2\"/>"),
              "byte_order=\"BigEndian\" header_type=\"UInt64\"");
  const std::string data("??\0\0\0\0\0\0\0\2\1\2", 12);
  text.insert(text.find("</VTKFile>"), "<AppendedData encoding=\"raw\">\n _" + data + "\n</AppendedData>");
  EXPECT_EQ(read(text).labels, (std::vector<Label>{258}));
  std::string beyond = text;
  beyond.replace(beyond.find("offset=\"2\""), 10, "offset=\"99\"");
  EXPECT_SAYS(refused<IoError>(beyond), "beyond the end");
}

// The block says that it unpacks to 2^40 bytes.
TEST_F(VtuFile, ImpossibleSizesAreRefused) {
  std::string text =
      file_of(piece("0 1 2 3", "<DataArray type=\"UInt8\" Name=\"label\" format=\"appended\" offset=\"0\"/>"),
              "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"");
  std::string sizes(32, '\0');
  sizes[0] = sizes[13] = sizes[24] = 1;
  text.insert(text.find("</VTKFile>"), "<AppendedData encoding=\"raw\">_" + sizes + "x</AppendedData>");
  EXPECT_SAYS(refused<IoError>(text), "impossible sizes");
  EXPECT_SAYS(refused<IoError>(file_of("<Piece NumberOfPoints=\"99999999999999999\" NumberOfCells=\"1\"/>")), "Points");
  EXPECT_SAYS(refused<IoError>(file_of("<Piece NumberOfPoints=\"-4\" NumberOfCells=\"1\"/>")), "NumberOfPoints");
}

TEST_F(VtuFile, ArraysThatDoNotFit) {
  EXPECT_SAYS(refused<IoError>(file_of(piece("0 1 2 3", array("Int32", "label", "7 8")))), "2 numbers for 1");
  EXPECT_SAYS(refused<IoError>(file_of(piece("0 1 2 3", array("Int32", "label", "7.5")))), "no number of its type");
  EXPECT_SAYS(refused<IoError>(file_of(piece("0 1 2"))), "out of order");
}

TEST_F(VtuFile, NamesAsStringsOfVtk) {
  const std::string names = "<FieldData>" + array("UInt8", "label_values", "7 9") +
                            array("String", "label_names", "66 111 0 -61 -92 0") + "</FieldData>";
  const TetMesh mesh = read(file_of(names + piece()));
  EXPECT_EQ(mesh.names, (LabelTable{{7, {"Bo", {}}}, {9, {"ä", {}}}}));
}

TEST_F(VtuFile, UnknownStorageIsRefused) {
  EXPECT_SAYS(refused<InvalidInput>(file_of(piece(), "compressor=\"vtkLZ4DataCompressor\"")), "vtkZLibDataCompressor");
  EXPECT_SAYS(refused<IoError>(file_of(piece(), "byte_order=\"Middle\"")), "LittleEndian or BigEndian");
  EXPECT_SAYS(refused<IoError>("<VTKFile type=\"PolyData\"><PolyData/></VTKFile>"), "no unstructured grid");
}

}  // namespace
}  // namespace anatomesh::testing
