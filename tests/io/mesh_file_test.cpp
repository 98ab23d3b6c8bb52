#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "io/mesh_file_fixture.h"
#include "io/mesh_format.h"

namespace anatomesh::testing {
namespace {

/// Labels at both ends of the range.
TetMesh two_tissues() { return two_uneven_tets(1, 4294967295U); }

/// Enough tetrahedra for several compressed blocks; they need not fit together.
TetMesh many_tets(std::size_t count) {
  TetMesh mesh;
  std::mt19937 random(5);
  for (std::size_t n = 0; n < count / 4 + 4; ++n) {
    const auto coordinate = [&] { return static_cast<double>(random()) / 1e7; };
    mesh.points_mm.push_back({coordinate(), coordinate(), coordinate()});
  }
  const auto vertex = [&] { return static_cast<VertexId>(random() % mesh.points_mm.size()); };
  for (std::size_t n = 0; n < count; ++n) {
    mesh.tets.push_back({vertex(), vertex(), vertex(), vertex()});
    mesh.labels.push_back(static_cast<Label>(random() % 200 * 21474836 + 1));
  }
  return mesh;
}

/// An ASCII .vtu of one tetrahedron and one triangle with the given cell arrays.
std::string vtu_text(const std::string& cell_arrays, const std::string& connectivity = "0 1 2 3 0 1 2") {
  return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
         "<Piece NumberOfPoints=\"4\" NumberOfCells=\"2\"><CellData>" +
         cell_arrays +
         "</CellData><Points>"
         "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray>"
         "</Points><Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" +
         connectivity +
         "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">4 7</DataArray>"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 5</DataArray></Cells></Piece>"
         "</UnstructuredGrid></VTKFile>";
}

std::string cell_array(const std::string& name, const std::string& type, const std::string& values) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"ascii\">" + values + "</DataArray>";
}

using MeshFile = MeshFileTest;

/// As far as the format can hold them.
TetMesh with_labels_for(const MeshFormat& format, TetMesh mesh) {
  for (Label& label : mesh.labels) label = std::min(label, format.largest_label);
  return mesh;
}

TEST_F(MeshFile, RoundTripsExactly) {
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr) continue;
    SCOPED_TRACE(format.extension);
    for (const TetMesh& any : {two_tissues(), many_tets(100000)}) {
      const TetMesh mesh = with_labels_for(format, any);
      const auto file = in_folder(std::string("mesh").append(format.extension));
      write_mesh(file, mesh);
      expect_same(read_mesh(file), mesh);
    }
  }
}

TEST_F(MeshFile, LabelsThatDoNotFitAreRefused) {
  for (const MeshFormat& format : mesh_formats()) {
    if (format.largest_label == std::numeric_limits<Label>::max()) continue;
    TetMesh mesh = two_tissues();
    mesh.labels.back() = format.largest_label + 1;
    const auto file = in_folder(std::string("mesh").append(format.extension));
    const std::string message = message_of<InvalidInput>(file, [&] { write_mesh(file, mesh); });
    EXPECT_NE(message.find(std::to_string(mesh.labels.back())), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(file));
  }
}

/// Names of all lengths that a format may store in its own way, and some that a parser may stumble over.
TetMesh named_tets() {
  TetMesh mesh = two_tissues();
  mesh.names[1] = {"Left \"ventricle\" <3 & co", Colour{255, 0, 17}};
  mesh.names[4294967295U] = {"Große Vene", Colour{1, 2, 3}};
  mesh.names[2] = {std::string(63, 'a'), Colour{}};
  mesh.names[3] = {std::string(64, 'b'), Colour{}};
  mesh.names[4] = {std::string(20000, 'c'), Colour{}};
  return mesh;
}

TEST_F(MeshFile, NamesRoundTrip) {
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr || !format.keeps_names) continue;
    SCOPED_TRACE(format.extension);
    const auto file = in_folder(std::string("mesh").append(format.extension));
    TetMesh mesh = with_labels_for(format, two_tissues());
    mesh.names[mesh.labels[0]] = {"Left ventricle", Colour{255, 0, 17}};
    mesh.names[mesh.labels[1]] = {"Grosse_Vene", Colour{1, 2, 3}};
    write_mesh(file, mesh);
    const TetMesh read = read_mesh(file);
    for (const Label label : mesh.labels) EXPECT_EQ(read.names.at(label).name, mesh.names.at(label).name);
  }
}

// These formats keep all of the table.
TEST_F(MeshFile, LabelTableRoundTrips) {
  for (const char* extension : {".vtu", ".vtk", ".xdmf"}) {
    const auto file = in_folder(std::string("mesh") + extension);
    TetMesh mesh = named_tets();
    write_mesh(file, mesh);
    expect_same(read_mesh(file), mesh);
    for (auto& [label, entry] : mesh.names) entry.colour.reset();
    write_mesh(file, mesh);
    expect_same(read_mesh(file), mesh);
  }
}

TEST_F(MeshFile, SameMeshSameBytes) {
  for (const MeshFormat& format : mesh_formats()) {
    const TetMesh mesh = with_labels_for(format, many_tets(1000));
    const std::string extension(format.extension);
    const auto file_in = [&](const std::string& name) {
      std::filesystem::create_directory(in_folder(name));
      return in_folder(name) / ("mesh" + extension);  // a file may name others of its own name
    };
    write_mesh(file_in("one"), mesh);
    write_mesh(file_in("two"), mesh);
    EXPECT_EQ(bytes_of(file_in("one")), bytes_of(file_in("two"))) << extension;
  }
}

TEST_F(MeshFile, FormatIsAsOtherToolsWantIt) {
  const std::string vtu = written("mesh.vtu", two_tissues());
  EXPECT_SAYS(vtu, "vtkZLibDataCompressor");
  EXPECT_SAYS(vtu, "type=\"UInt32\" Name=\"label\" format=\"appended\"");
  EXPECT_SAYS(vtu, "type=\"Float64\" Name=\"Points\"");
  const std::string vtk = written("mesh.vtk", two_tissues());
  EXPECT_SAYS(vtk, "# vtk DataFile Version 4.2");
  EXPECT_SAYS(vtk, "BINARY");
  EXPECT_SAYS(vtk, "POINTS 5 double");
  EXPECT_SAYS(vtk, "SCALARS label unsigned_int");
}

TEST_F(MeshFile, LabelArrayOfOtherTools) {
  const auto label_from = [&](const std::string& arrays) {
    const TetMesh mesh = read_mesh(put("mesh.vtu", vtu_text(arrays)));
    EXPECT_EQ(mesh.tets.size(), 1U);  // the triangle is left out
    return mesh.labels.at(0);
  };
  EXPECT_EQ(label_from(""), 1U);
  EXPECT_EQ(label_from(cell_array("quality", "Float32", "0.5 0.5")), 1U);
  EXPECT_EQ(label_from(cell_array("anything", "Int32", "7 8")), 7U);
  EXPECT_EQ(label_from(cell_array("GlobalIds", "Int32", "7 8")), 1U);
  EXPECT_EQ(label_from(cell_array("anything", "Int32", "7 8") + cell_array("Medit:Ref", "Int64", "9 9")), 9U);
  EXPECT_EQ(label_from(cell_array("gmsh:physical", "Int32", "3 3") + cell_array("LABEL", "UInt8", "4 4")), 4U);
  EXPECT_EQ(label_from(cell_array("label", "Float64", "4294967295 0")), 4294967295U);
}

TEST_F(MeshFile, LabelsMustBeWholeNumbers) {
  const std::string file = "mesh.vtu";
  EXPECT_SAYS(refused<InvalidInput>(file, vtu_text(cell_array("label", "Int32", "-2 1"))), "the value -2");
  EXPECT_SAYS(refused<InvalidInput>(file, vtu_text(cell_array("label", "Float32", "1.5 1"))), "the value 1.5");
  EXPECT_SAYS(refused<InvalidInput>(file, vtu_text(cell_array("label", "Int64", "4294967296 1"))), "4294967296");
}

TEST_F(MeshFile, LegacyAscii) {
  const std::string text =
      "# vtk DataFile Version 2.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
      "CELLS 2 9\n3 0 1 2\n4 0 1 2 3\nCELL_TYPES 2\n5 10\nCELL_DATA 2\nSCALARS quality float 1\nLOOKUP_TABLE default\n"
      "0.5 0.5\nSCALARS material int 1\nLOOKUP_TABLE default\n3 4\n";
  const TetMesh mesh = read_mesh(put("mesh.vtk", text));
  ASSERT_EQ(mesh.tets.size(), 1U);
  EXPECT_EQ(mesh.tets[0], (std::array<VertexId, 4>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.labels[0], 4U);
}

TEST_F(MeshFile, IdsOutOfRangeAreRefused) {
  EXPECT_SAYS(refused<IoError>("mesh.vtu", vtu_text("", "0 1 2 4 0 1 2")), "point 4");
  EXPECT_SAYS(refused<IoError>("mesh.vtu", vtu_text("", "0 1 2 -1 0 1 2")), "point -1");
  const std::string text =
      "# vtk DataFile Version 2.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
      "CELLS 1 5\n4 0 1 2 99\nCELL_TYPES 1\n10\n";
  EXPECT_SAYS(refused<IoError>("mesh.vtk", text), "point 99");
}

TEST_F(MeshFile, UnusableFilesAreRefused) {
  const auto missing = in_folder("missing.vtu");
  EXPECT_SAYS(message_of<IoError>(missing, [&] { read_mesh(missing); }), "there is no file");
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr) continue;
    const std::string name = std::string("mesh").append(format.extension);
    EXPECT_SAYS(refused<IoError>(name, ""), "empty");
    refused<Error>(name, "something else");
    refused<Error>(name, std::string(1000, '\0'));
  }
  const std::string message = refused<InvalidInput>("mesh.obj", "v 0 0 0");
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr) continue;
    EXPECT_SAYS(message, format.extension);
  }
  EXPECT_SAYS(refused<IoError>("mesh.vtk", "# vtk DataFile Version 2.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n"),
              "unstructured grid");
}

TEST_F(MeshFile, MeshWithoutTetrahedraIsRefused) {
  std::string triangles = vtu_text("");
  triangles.replace(triangles.find("10 5"), 4, "9 5 ");
  EXPECT_SAYS(refused<InvalidInput>("mesh.vtu", triangles), "no tetrahedra of 4 or 10 nodes");
}

TEST_F(MeshFile, TruncatedFilesAreRefused) {
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr) continue;
    const std::string extension(format.extension);
    const std::string bytes = written("whole" + extension, with_labels_for(format, many_tets(2000)));
    for (std::size_t part = 1; part < 40; ++part) {
      refused<IoError>("cut" + extension, bytes.substr(0, part * bytes.size() / 40));
    }
  }
}

TEST_F(MeshFile, DamagedFilesNeverCrash) {
  std::mt19937 random(3);
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr) continue;
    const std::string extension(format.extension);
    const std::string bytes = written("whole" + extension, with_labels_for(format, many_tets(50)));
    for (int trial = 0; trial < 300; ++trial) {
      message_of_damaged(put("damaged" + extension, with_changed_bytes(bytes, 1 + trial % 5, random)));
    }
  }
}

TEST_F(MeshFile, OneLabelEachIsNeeded) {
  TetMesh mesh = two_tissues();
  mesh.labels.pop_back();
  const auto file = in_folder("mesh.vtu");
  EXPECT_SAYS(message_of<InvalidInput>(file, [&] { write_mesh(file, mesh); }), "1 labels for 2");
  EXPECT_EQ(folder_listing(), "");
}

}  // namespace
}  // namespace anatomesh::testing
