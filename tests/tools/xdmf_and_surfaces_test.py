#!/usr/bin/env python3
"""XDMF files and surfaces as meshio, h5py and VTK read them, and XDMF files as meshio writes them.

usage: xdmf_and_surfaces_test.py ANATOMESH      exit status 77 (skipped) without numpy, h5py or meshio
"""
import pathlib
import tempfile
import unittest

from demo_meshes import (checked_volumes_mm3, convert, is_closed, meshes, needed_packages, nested_balls,
                         run_tests, volume_inside)

with needed_packages():
    import h5py
    import meshio
    import numpy as np


def read_stl(path):
    """Corners (triangles, 3, 3) of a binary STL file."""
    data = path.read_bytes()
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
    triangles = np.frombuffer(data, triangle, offset=84)
    assert len(triangles) == int.from_bytes(data[80:84], "little")
    return triangles["corners"]


def read_ply(path):
    """Points and faces of a binary PLY file with labels, without colours."""
    head, data = path.read_bytes().split(b"end_header\n", 1)
    points, faces = (int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element"))
    face = np.dtype([("size", "u1"), ("corners", "<i4", 3), ("label", "<u4"), ("label_outside", "<u4")])
    assert len(data) == 24 * points + face.itemsize * faces
    return np.frombuffer(data, "<f8", 3 * points).reshape(-1, 3), np.frombuffer(data, face, offset=24 * points)


def read_with_vtk(path):
    """The surface of a .vtp or .ply file; None without VTK."""
    try:
        from vtkmodules.vtkIOPLY import vtkPLYReader
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    except ImportError:
        return None
    reader = {".vtp": vtkXMLPolyDataReader, ".ply": vtkPLYReader}[path.suffix]()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def ids_of(corners):
    """Triangles by numbers of their points, where equal points are one."""
    return np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)[1].reshape(-1, 3)


def labels_of(mesh):
    return mesh.cell_data["label"][0].ravel()


class Files(unittest.TestCase):
    def assert_same(self, mesh, expected):
        self.assertEqual([block.type for block in mesh.cells], ["tetra"])
        np.testing.assert_array_equal(mesh.points, expected.points)
        np.testing.assert_array_equal(mesh.cells[0].data, expected.cells[0].data)
        np.testing.assert_array_equal(labels_of(mesh), labels_of(expected))

    def test_xdmf_as_meshio_reads_it(self):
        for path, expected in MESHES.items():
            with self.subTest(mesh=path.name):
                convert(path, path.with_suffix(".xdmf"))
                self.assert_same(meshio.read(path.with_suffix(".xdmf")), expected)
                with h5py.File(path.with_suffix(".h5")) as file:
                    self.assertEqual(file["mesh/points"].dtype, np.float64)
                    np.testing.assert_array_equal(file["mesh/points"], expected.points)
                    np.testing.assert_array_equal(file["mesh/tetrahedra"], expected.cells[0].data)
                    np.testing.assert_array_equal(file["mesh/label"], labels_of(expected))

    def test_facets_bound_the_tissues(self):
        for path in MESHES:
            with self.subTest(mesh=path.name):
                convert(path, path.with_suffix(".xdmf"))
                facets = meshio.read(path.with_name(path.stem + "_facets.xdmf"))
                triangles, data = facets.cells[0].data, {n: v[0] for n, v in facets.cell_data.items()}
                pairs = {(number, inside, outside) for number, inside, outside in
                         zip(data["interface"], data["label"], data["label_outside"])}
                self.assertEqual(sorted(number for number, _, _ in pairs), list(range(1, len(pairs) + 1)))
                self.assertEqual({value for value, _ in facets.field_data.values()}, {n for n, _, _ in pairs})
                for label, volume in checked_volumes_mm3(path).items():
                    around = np.concatenate([triangles[data["label"] == label],
                                             triangles[data["label_outside"] == label][:, ::-1]])
                    self.assertTrue(is_closed(around))
                    self.assertAlmostEqual(volume_inside(facets.points[around]) / volume, 1, delta=1e-9)

    def test_xdmf_of_meshio(self):
        for path, expected in MESHES.items():
            for data_format in ("HDF", "XML"):
                with self.subTest(mesh=path.name, data_format=data_format):
                    theirs, back = path.with_name("theirs.xdmf"), path.with_name("back.vtk")
                    meshio.xdmf.write(theirs, expected, data_format=data_format)
                    convert(theirs, back)
                    self.assert_same(meshio.read(back), expected)

    def test_names(self):
        path = next(iter(MESHES))
        named = path.with_name("named.xdmf")
        convert(path, named)
        text = named.read_text(encoding="utf-8")
        self.assertNotIn("Information", text)      # there are no names
        information = '<Information Name="labels" Value=""><![CDATA[<main><map key="The &amp; inner" dim="3" ' \
                      'colour="#0a00ff">2</map><map key="Outer" dim="3">7</map></main>]]></Information></Grid>'
        named.write_text(text.replace("</Grid>", information), encoding="utf-8")
        again = path.with_name("again.xdmf")
        convert(named, again)
        self.assertEqual({name: list(value) for name, value in meshio.read(again).field_data.items()},
                         {"The & inner": [2, 3], "Outer": [7, 3]})
        with h5py.File(again.with_suffix(".h5")) as file:
            self.assertEqual(list(file["labels/names"].asstr()), ["The & inner", "Outer"])
            self.assertEqual(list(file["labels/values"]), [2, 7])
        convert(named, path.with_name("named.stl"), "--per-tissue")
        self.assertTrue(path.with_name("named_The___inner.stl").exists())

    def test_stl_of_each_tissue_is_closed_and_has_its_volume(self):
        for path in MESHES:
            convert(path, path.with_suffix(".stl"), "--per-tissue")
            for label, volume in checked_volumes_mm3(path).items():
                with self.subTest(mesh=path.name, label=label):
                    corners = read_stl(path.with_name(f"{path.stem}_label_{label}.stl"))
                    self.assertTrue(is_closed(ids_of(corners)))
                    self.assertAlmostEqual(volume_inside(corners.astype(float)) / volume, 1, delta=1e-4)  # 32-bit points

    def test_surfaces_have_the_same_triangles(self):
        for path in MESHES:
            with self.subTest(mesh=path.name):
                for extension in (".stl", ".ply", ".obj"):
                    convert(path, path.with_suffix(extension))
                points, faces = read_ply(path.with_suffix(".ply"))
                self.assertEqual(len(np.unique(faces["corners"])), len(points))
                facets, obj = meshio.read(self.facets_of(path)), meshio.read(path.with_suffix(".obj"))
                corners = facets.points[facets.cells[0].data]
                np.testing.assert_array_equal(points[faces["corners"]], corners)
                np.testing.assert_array_equal(obj.points[obj.cells_dict["triangle"]], corners)
                np.testing.assert_array_equal(read_stl(path.with_suffix(".stl")), corners.astype(np.float32))
                for name in ("label", "label_outside"):
                    np.testing.assert_array_equal(faces[name], facets.cell_data[name][0])

    def test_surfaces_as_vtk_reads_them(self):
        for path in MESHES:
            facets = meshio.read(self.facets_of(path))
            for extension in (".vtp", ".ply"):
                convert(path, path.with_suffix(extension))
                data = read_with_vtk(path.with_suffix(extension))
                if data is None:
                    self.skipTest("VTK's Python is not installed")
                self.assertEqual(data.GetNumberOfPolys(), len(facets.cells[0].data))
                self.assertEqual(data.GetNumberOfPoints(), len(np.unique(facets.cells[0].data)))
            data = read_with_vtk(path.with_suffix(".vtp"))
            for name in ("label", "label_outside"):
                array = data.GetCellData().GetArray(name)
                values = [array.GetValue(n) for n in range(array.GetNumberOfValues())]
                np.testing.assert_array_equal(values, facets.cell_data[name][0])
            self.assertEqual(data.GetPoint(0), tuple(facets.points[facets.cells[0].data.min()]))

    @staticmethod
    def facets_of(path):
        convert(path, path.with_suffix(".xdmf"))
        return path.with_name(path.stem + "_facets.xdmf")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        MESHES = {path: meshio.read(path) for path in meshes(pathlib.Path(place), nested_balls()).values()}
        run_tests()
