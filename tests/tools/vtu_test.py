#!/usr/bin/env python3
"""`anatomesh` reads the .vtu files of VTK and meshio in all their encodings, and they read its own.

usage: vtu_test.py ANATOMESH      exit status 77 (skipped) without numpy, meshio or VTK for Python
"""
import itertools
import pathlib
import tempfile
import unittest

from demo_meshes import anatomesh, convert, needed_packages, quiet, run_tests

with needed_packages():
    import meshio
    import numpy as np
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
    from vtkmodules.vtkCommonDataModel import VTK_TETRA, VTK_TRIANGLE, vtkUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter

LABELS = (3, 250)
NAMES = ("White matter", "Große Vene")


def row_of_tets(count):
    """Points and tetrahedra of which each shares a face with the next."""
    random = np.random.default_rng(7)
    points = random.normal(size=(count + 3, 3)) * 50 / 3
    return points, np.stack([np.arange(count) + n for n in range(4)], axis=1)


def vtk_grid(points, tets, labels, triangles=()):
    grid = vtkUnstructuredGrid()
    place = vtkPoints()
    place.SetData(numpy_to_vtk(points, deep=True))
    grid.SetPoints(place)
    for triangle in triangles:
        grid.InsertNextCell(VTK_TRIANGLE, 3, triangle)
    for tet in tets.tolist():
        grid.InsertNextCell(VTK_TETRA, 4, tet)
    for name, values in (("quality", np.random.default_rng(1).random(grid.GetNumberOfCells())),
                         ("label", np.append(np.zeros(len(triangles), labels.dtype), labels))):
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        grid.GetCellData().AddArray(array)
    names = vtkStringArray()
    names.SetName("label_names")
    for name in NAMES:
        names.InsertNextValue(name)
    values = numpy_to_vtk(np.array(LABELS, np.int16), deep=True)
    values.SetName("label_values")
    for array in (values, names):
        grid.GetFieldData().AddArray(array)
    return grid


class Vtu(unittest.TestCase):
    def setUp(self):
        self.kept = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.kept.name)
        self.points, self.tets = row_of_tets(20000)
        self.labels = np.where(np.arange(len(self.tets)) % 3, *LABELS).astype(np.int32)

    def tearDown(self):
        self.kept.cleanup()

    def converted(self, path, out="out.vtu"):
        return convert(path, self.folder / out)

    def expect_tets(self, path, tolerance=0):
        """Text has fewer digits than are needed."""
        mesh = meshio.read(self.converted(path))
        np.testing.assert_allclose(mesh.points, self.points, rtol=tolerance)
        np.testing.assert_array_equal(mesh.cells[0].data, self.tets)
        np.testing.assert_array_equal(mesh.cell_data["label"][0], self.labels)

    def names_in(self, path):
        text = self.converted(path, "names.mesh").read_text(encoding="utf-8")
        return [line for line in text.splitlines() if line.startswith("# label")]

    def write(self, grid, mode, encoded, compressor, order, header, pieces=1):
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetInputData(grid)
        writer.SetFileName(str(self.folder / "in.vtu"))
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.SetEncodeAppendedData(encoded)
        getattr(writer, f"SetCompressorTypeTo{compressor}")()
        getattr(writer, f"SetByteOrderTo{order}")()
        getattr(writer, f"SetHeaderTypeTo{header}")()
        writer.SetNumberOfPieces(pieces)
        self.assertEqual(writer.Write(), 1)
        return self.folder / "in.vtu"

    def test_all_encodings_of_vtk(self):
        grid = vtk_grid(self.points, self.tets, self.labels, triangles=((0, 1, 2), (1, 2, 3)))
        for case in itertools.product((("Ascii", 0), ("Binary", 0), ("Appended", 0), ("Appended", 1)), ("None", "ZLib"),
                                      ("LittleEndian", "BigEndian"), ("UInt32", "UInt64")):
            (mode, encoded), compressor, order, header = case
            with self.subTest(case=case):
                path = self.write(grid, mode, encoded, compressor, order, header)
                self.expect_tets(path, tolerance=1e-9 if mode == "Ascii" else 0)
                self.assertEqual(self.names_in(path), [f"# label {label} {name}" for label, name in zip(LABELS, NAMES)])

    def test_all_number_types(self):
        for kind in (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64, np.float32,
                     np.float64):
            with self.subTest(type=kind.__name__):
                self.labels = np.where(np.arange(len(self.tets)) % 3, 3, 120).astype(kind)
                grid = vtk_grid(self.points, self.tets, self.labels)
                self.expect_tets(self.write(grid, "Appended", 0, "ZLib", "BigEndian", "UInt64"))

    def test_points_of_32_bits(self):
        self.points = self.points.astype(np.float32)
        grid = vtk_grid(self.points, self.tets, self.labels)
        self.expect_tets(self.write(grid, "Binary", 0, "ZLib", "LittleEndian", "UInt32"))

    def test_pieces(self):
        """The writer cuts grids into pieces, with points of their own."""
        path = self.write(vtk_grid(self.points, self.tets, self.labels), "Appended", 0, "ZLib", "LittleEndian", "UInt32", 3)
        expected = vtkXMLUnstructuredGridReader()
        expected.SetFileName(str(path))
        expected.Update()
        grid = expected.GetOutput()
        mesh = meshio.read(self.converted(path))
        np.testing.assert_array_equal(mesh.points, vtk_to_numpy(grid.GetPoints().GetData()))
        np.testing.assert_array_equal(mesh.cells[0].data.ravel(), vtk_to_numpy(grid.GetCells().GetConnectivityArray()))
        np.testing.assert_array_equal(mesh.cell_data["label"][0], vtk_to_numpy(grid.GetCellData().GetArray("label")))

    def test_other_compressors_are_refused(self):
        grid = vtk_grid(self.points, self.tets, self.labels)
        for compressor in ("LZ4", "LZMA"):
            path = self.write(grid, "Appended", 0, compressor, "LittleEndian", "UInt32")
            done = anatomesh("convert", path, self.folder / "out.vtu", check=False)
            self.assertEqual(done.returncode, 3)
            self.assertIn(f"vtk{compressor}DataCompressor", done.stderr)
            self.assertIn("vtkZLibDataCompressor", done.stderr)

    def test_all_encodings_of_meshio(self):
        mesh = meshio.Mesh(self.points, [("tetra", self.tets)], cell_data={"label": [self.labels]})
        for binary, compression, header in ((False, None, None), (True, None, "UInt32"), (True, "zlib", "UInt32"),
                                            (True, "zlib", "UInt64"), (True, None, "UInt64")):
            with self.subTest(binary=binary, compression=compression, header=header):
                with quiet():
                    meshio.vtu.write(self.folder / "in.vtu", mesh, binary=binary, compression=compression,
                                     header_type=header)
                self.expect_tets(self.folder / "in.vtu", tolerance=0 if binary else 1e-9)

    def test_vtk_reads_ours(self):
        path = self.write(vtk_grid(self.points, self.tets, self.labels), "Appended", 0, "None", "LittleEndian", "UInt32")
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(self.converted(path)))
        reader.Update()
        grid = reader.GetOutput()
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetPoints().GetData()), self.points)
        np.testing.assert_array_equal(vtk_to_numpy(grid.GetCellData().GetArray("label")), self.labels)
        names = vtk_to_numpy(grid.GetFieldData().GetArray("label_names")).tobytes()
        self.assertEqual(names, b"".join(name.encode() + b"\0" for name in NAMES))


if __name__ == "__main__":
    run_tests()
