#!/usr/bin/env python3
"""Files for solvers, as programs see them that are not ours: meshio, CalculiX, TetGen and Python's XML.

usage: solver_files_test.py ANATOMESH      exit status 77 (skipped) without numpy or meshio
"""
import pathlib
import re
import shutil
import tempfile
import unittest
import xml.etree.ElementTree

from demo_meshes import Mesh, balls, convert, meshes, needed_packages, run, run_tests

with needed_packages():
    import meshio
    import numpy as np


def vertices(faces):
    return np.unique(np.array(list(faces)))


def in_place_of_labels(names):
    """Names of surfaces as the two labels, like the keys of Mesh.surfaces()."""
    found = {}
    for name in names:
        labels = [int(n) for n in re.findall(r"label_(\d+)", name, re.IGNORECASE)]
        if labels:
            found[name] = (labels[0], 0) if name.lower().endswith("_skin") else (labels[0], labels[1])
    return found


class Folder(unittest.TestCase):
    """A folder with two meshes in it: of balls, and of the AAL atlas where that is there."""

    holder, meshes = None, {}

    @classmethod
    def setUpClass(cls):
        if cls.holder:
            return
        Folder.holder = tempfile.TemporaryDirectory()
        for name, path in meshes(cls.folder(), balls(), "--bcc-size", "4").items():
            mesh = meshio.read(path)
            cls.meshes[name] = Mesh(mesh.points, mesh.cells_dict["tetra"], mesh.cell_data["label"][0])

    @classmethod
    def folder(cls):
        return pathlib.Path(cls.holder.name)

    def converted(self, name, extension):
        return convert(self.folder() / f"{name}.vtk", self.folder() / f"{name}{extension}")

    def each(self, check, extension):
        for name, mesh in self.meshes.items():
            with self.subTest(mesh=name):
                check(mesh, self.converted(name, extension))


class ReadByMeshio(Folder):
    def test_abaqus(self):
        self.each(self.check_abaqus, ".inp")

    def check_abaqus(self, mesh, path):
        read = meshio.read(path)
        np.testing.assert_array_equal(read.points, mesh.points)
        self.assertEqual(len(read.cells), len(np.unique(mesh.labels)))
        for block, cells in enumerate(read.cells):
            (name,) = [name for name, sets in read.cell_sets.items() if len(sets[block])]
            label = int(re.fullmatch(r"label_(\d+)", name)[1])
            np.testing.assert_array_equal(cells.data, mesh.tets[mesh.labels == label])
        expected = mesh.surfaces()
        pairs = in_place_of_labels(read.point_sets)
        self.assertEqual(set(pairs.values()), set(expected))
        for name, pair in pairs.items():
            np.testing.assert_array_equal(read.point_sets[name], vertices(expected[pair]))
        skin = [face for pair, faces in expected.items() if pair[1] == 0 for face in faces]
        np.testing.assert_array_equal(read.point_sets["skin"], vertices(skin))

    def test_nastran(self):
        self.each(self.check_nastran, ".bdf")

    def check_nastran(self, mesh, path):
        read = meshio.read(path)
        np.testing.assert_allclose(read.points, mesh.points, rtol=0, atol=6e-13)  # 16 characters
        np.testing.assert_array_equal(read.cells_dict["tetra"], mesh.tets)
        np.testing.assert_array_equal(read.cell_data["nastran:ref"][0], mesh.labels)

    def test_tetgen(self):
        for extension in (".node", ".ele"):
            self.each(self.check_tetgen, extension)

    def check_tetgen(self, mesh, path):
        read = meshio.read(path)
        np.testing.assert_array_equal(read.points, mesh.points)
        np.testing.assert_array_equal(read.cells_dict["tetra"], mesh.tets)
        np.testing.assert_array_equal(read.cell_data["tetgen:ref"][0], mesh.labels)


class WrittenByMeshio(Folder):
    def test_all(self):
        mesh = self.meshes["balls"]
        data = {".bdf": {"nastran:ref": [mesh.labels]}, ".node": {"tetgen:ref": [mesh.labels]}, ".inp": {}}
        for extension, cell_data in data.items():
            with self.subTest(extension=extension):
                sets = {f"s{label}": [np.flatnonzero(mesh.labels == label)] for label in np.unique(mesh.labels)}
                meshio.Mesh(mesh.points, [("tetra", mesh.tets)], cell_data=cell_data,
                            cell_sets=sets).write(self.folder() / f"other{extension}")
                read = meshio.read(convert(self.folder() / f"other{extension}", self.folder() / "copy.node"))
                np.testing.assert_allclose(read.points, mesh.points, rtol=1e-10 if extension == ".bdf" else 0, atol=0)
                np.testing.assert_array_equal(read.cells_dict["tetra"], mesh.tets)
                expected = mesh.labels if cell_data else np.searchsorted(np.unique(mesh.labels), mesh.labels) + 1
                np.testing.assert_array_equal(read.cell_data["tetgen:ref"][0], expected)


def numbers(node, kind=int):
    return [kind(word) for word in node.text.split(",")]


class ReadAsXml(Folder):
    def test_febio(self):
        self.each(self.check_febio, ".feb")

    def check_febio(self, mesh, path):
        model = xml.etree.ElementTree.parse(path).getroot()
        self.assertEqual((model.tag, model.get("version")), ("febio_spec", "4.0"))
        nodes = model.findall("Mesh/Nodes/node")
        np.testing.assert_array_equal([numbers(n, float) for n in nodes], mesh.points)
        self.assertEqual([n.get("id") for n in nodes], [str(n + 1) for n in range(len(nodes))])
        self.check_parts(mesh, model)
        self.check_surfaces(mesh, model)

    def check_parts(self, mesh, model):
        parts = model.findall("Mesh/Elements")
        for part in parts:
            label = int(re.fullmatch(r"label_(\d+)", part.get("name"))[1])
            self.assertEqual(part.get("type"), "tet4")
            self.assertEqual([int(e.get("id")) - 1 for e in part], list(np.flatnonzero(mesh.labels == label)))
            np.testing.assert_array_equal([numbers(e) for e in part], mesh.tets[mesh.labels == label] + 1)
        names = [part.get("name") for part in parts]
        self.assertEqual([m.get("name") for m in model.findall("Material/material")], names)
        self.assertEqual([(d.get("name"), d.get("mat")) for d in model.findall("MeshDomains/SolidDomain")],
                         list(zip(names, names)))

    def check_surfaces(self, mesh, model):
        expected = mesh.surfaces()
        surfaces = {s.get("name"): s for s in model.findall("Mesh/Surface")}
        sets = {s.get("name"): numbers(s) for s in model.findall("Mesh/NodeSet")}
        self.assertEqual(set(surfaces), set(sets))
        pairs = in_place_of_labels(surfaces)
        self.assertEqual(set(pairs.values()), set(expected))
        for name, pair in pairs.items():
            faces = {tuple(sorted(n - 1 for n in numbers(face))) for face in surfaces[name]}
            self.assertEqual(faces, expected[pair])
            self.assertEqual(set(sets[name]), {v + 1 for face in faces for v in face})


@unittest.skipUnless(shutil.which("tetgen"), "tetgen is not installed")
class ReadByTetGen(Folder):
    def test_keeps_the_mesh(self):
        """TetGen takes the mesh as it is (-r) and writes it anew, with its regions."""
        self.each(self.check_regions, ".node")

    def check_regions(self, mesh, path):
        run("tetgen", "-rQ", path)
        read = meshio.read(path.with_suffix(".1.ele"))
        copy = Mesh(read.points, read.cells_dict["tetra"], read.cell_data["tetgen:ref"][0])
        for label in np.unique(mesh.labels):
            self.assertEqual((copy.labels == label).sum(), (mesh.labels == label).sum())
            self.assertAlmostEqual(np.abs(copy.volumes[copy.labels == label]).sum(),
                                   mesh.volumes[mesh.labels == label].sum())


@unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed")
class SolvedByCalculix(Folder):
    """Loads whose reactions are known without solving anything."""

    DENSITY = {3: 1.1e-9, 7: 2.7e-9, 200: 0.4e-9}     # tonne/mm^3
    YOUNG_MPA = {3: 0.003, 7: 0.3, 200: 0.01}
    GRAVITY = 9810.0                                  # mm/s^2, against the third axis

    def solved(self, load):
        """Reactions of the nodes on the small ball's skin, which are held, and volumes by tissue."""
        self.converted("balls", ".inp")
        deck = ["*INCLUDE, INPUT=balls.inp"]
        for label, young in self.YOUNG_MPA.items():
            deck += [f"*MATERIAL, NAME=M{label}", "*ELASTIC", f"{young}, 0.3", "*DENSITY", f"{self.DENSITY[label]}",
                     f"*SOLID SECTION, ELSET=label_{label}, MATERIAL=M{label}"]
        deck += ["*BOUNDARY", "label_200_skin, 1, 3", "*STEP", "*STATIC", *load,
                 "*NODE PRINT, NSET=label_200_skin, TOTALS=ONLY", "RF"]
        for label in self.YOUNG_MPA:
            deck += [f"*EL PRINT, ELSET=label_{label}, TOTALS=ONLY", "EVOL"]
        (self.folder() / "deck.inp").write_text("\n".join(deck + ["*END STEP", ""]), encoding="ascii")
        run("ccx", "deck", folder=self.folder())
        text = (self.folder() / "deck.dat").read_text(encoding="ascii")
        reaction = re.search(r"total force.*\n\n\s*(\S+)\s+(\S+)\s+(\S+)", text)
        volumes = re.findall(r"total volume.*set LABEL_(\d+) .*\n\n\s*(\S+)", text)
        return np.array([float(n) for n in reaction.groups()]), {int(label): float(v) for label, v in volumes}

    def free_share(self, corners):
        """The share of a load, evenly spread over these corners, that does not lie on held nodes."""
        return 1 - np.isin(corners, vertices(self.meshes["balls"].surfaces()[200, 0])).mean(axis=1)

    def test_weight(self):
        """The reactions carry all weight but what lies on the held nodes themselves."""
        mesh = self.meshes["balls"]
        reaction, volumes = self.solved(["*DLOAD"] + [f"label_{label}, GRAV, {self.GRAVITY}, 0., 0., -1."
                                                      for label in self.DENSITY])
        self.assertEqual(set(volumes), set(self.DENSITY))
        for label, volume in volumes.items():
            self.assertAlmostEqual(volume / mesh.volumes[mesh.labels == label].sum(), 1, places=5)
        weights = mesh.volumes * np.array([self.DENSITY[label] for label in mesh.labels]) * self.GRAVITY
        np.testing.assert_allclose(reaction, (0, 0, (weights * self.free_share(mesh.tets)).sum()), rtol=1e-4, atol=1e-9)

    def test_pressure(self):
        """A pressure on the large ball's skin, whose faces are told by the numbers of their elements' sides."""
        mesh = self.meshes["balls"]
        reaction, _ = self.solved(["*DSLOAD", "label_3_skin, P, 2e-6"])
        corners, inside, outside = mesh.outward_faces()
        corners = corners[(inside == 3) & (outside == 0)]
        a, b, c = (mesh.points[corners[:, n]] for n in range(3))
        forces = 2e-6 * np.cross(b - a, c - a) / 2 * self.free_share(corners)[:, None]
        np.testing.assert_allclose(reaction, forces.sum(axis=0), rtol=1e-3, atol=1e-9)


if __name__ == "__main__":
    run_tests()
