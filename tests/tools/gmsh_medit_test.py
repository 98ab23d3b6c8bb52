#!/usr/bin/env python3
"""Gmsh and meshio read the .msh and .mesh files of `anatomesh`, and `anatomesh` reads theirs.

usage: gmsh_medit_test.py ANATOMESH      exit status 77 (skipped) without numpy, meshio or gmsh
"""
import pathlib
import shutil
import tempfile
import unittest

from demo_meshes import Mesh, balls, checked_volumes_mm3, convert, meshes, needed_packages, quiet, run, run_tests, skip

with needed_packages():
    import meshio
    import numpy as np

GMSH = shutil.which("gmsh") or skip("there is no gmsh")
NAMES = {3: "White matter", 200: "Große \"Vene\"", 7: "x" * 200}


def read(path):
    with quiet():
        return meshio.read(path)


def write(path, mesh, **options):
    with quiet():
        mesh.write(path, **options)


def tissues_of(mesh, array):
    """All tetrahedra and their labels, by ascending label and else in the order of the file."""
    blocks = [(block.data, labels) for block, labels in zip(mesh.cells, mesh.cell_data[array]) if block.type == "tetra"]
    tets, labels = (np.concatenate(parts) for parts in zip(*blocks))
    order = np.argsort(labels, kind="stable")
    return Mesh(mesh.points, tets[order], labels[order])


def with_names(vtu):
    """The same mesh with names, through comments of a .mesh file."""
    mesh = convert(vtu, vtu.with_name("named.mesh"))
    comments = "".join(f"# label {label} {name}\n" for label, name in NAMES.items())
    mesh.write_text(mesh.read_text().replace("Dimension 3\n", "Dimension 3\n" + comments, 1))
    return mesh


class Formats(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.kept.name)
        cls.meshes = meshes(cls.folder, balls(), "--bcc-size", "4", spacing_mm=1.3, extension=".vtu")
        cls.named = with_names(cls.meshes["balls"])

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    def each_mesh(self, extension):
        for name, vtu in self.meshes.items():
            with self.subTest(mesh=name):
                yield name, vtu, convert(self.named if name == "balls" else vtu, vtu.with_suffix(extension))

    def expect_same(self, first, second):
        """The same bytes once both are .vtu."""
        pair = [convert(path, path.with_name(f"{n}.vtu")).read_bytes() for n, path in enumerate((first, second))]
        self.assertTrue(pair[0] == pair[1], f"{first.name} and {second.name} differ")

    def expect_same_mesh(self, vtu, path, array):
        """Corner by corner, and the volumes that `anatomesh check` finds."""
        expected, mesh = tissues_of(read(vtu), "label"), read(path)
        tissues = tissues_of(mesh, array)
        np.testing.assert_array_equal(tissues.labels, expected.labels)
        np.testing.assert_array_equal(tissues.points[tissues.tets], expected.points[expected.tets])
        self.expect_volumes(tissues.tissue_volumes(), checked_volumes_mm3(path))
        return mesh, tissues

    def expect_volumes(self, volumes, expected):
        self.assertEqual(set(volumes), set(expected))
        for label, volume in expected.items():
            self.assertAlmostEqual(volumes[label] / volume, 1, delta=1e-9)

    def expect_surfaces(self, mesh, tissues, array):
        """A number for each surface, of no other group; returns the pair of tissues of each."""
        expected = {frozenset(faces): pair for pair, faces in tissues.surfaces().items()}
        pair_of = {}
        numbered = [(block.data, tags) for block, tags in zip(mesh.cells, mesh.cell_data[array])
                    if block.type == "triangle"]
        triangles, tags = (np.concatenate(parts) for parts in zip(*numbered))
        for tag in np.unique(tags):
            faces = frozenset(tuple(sorted(face)) for face in triangles[tags == tag].tolist())
            pair_of[int(tag)] = expected.pop(faces)
        self.assertEqual(expected, {})
        self.assertFalse(set(pair_of) & set(tissues.labels.tolist()))
        return pair_of

    def test_meshio_reads_msh(self):
        for name, vtu, msh in self.each_mesh(".msh"):
            mesh, tissues = self.expect_same_mesh(vtu, msh, "gmsh:physical")
            pair_of = self.expect_surfaces(mesh, tissues, "gmsh:physical")
            groups = {(int(dimension), int(tag)): group for group, (tag, dimension) in mesh.field_data.items()}
            self.assertEqual(set(groups), {(3, int(label)) for label in tissues.labels} | {(2, tag) for tag in pair_of})
            if name == "balls":
                named = {3: "White matter", 200: "Große _Vene_", 7: "x" * 120}
                self.assertEqual({label: groups[3, label] for label in NAMES}, named)
                self.assertEqual({groups[2, tag]: pair for tag, pair in pair_of.items()},
                                 {"White matter_skin": (3, 0), "Große _Vene__skin": (200, 0),
                                  "White matter_to_Große _Vene_": (3, 200), "interface_3_7": (3, 7)})

    def test_meshio_reads_mesh(self):
        for _, vtu, path in self.each_mesh(".mesh"):
            mesh, tissues = self.expect_same_mesh(vtu, path, "medit:ref")
            np.testing.assert_array_equal(mesh.points, read(vtu).points)
            self.expect_surfaces(mesh, tissues, "medit:ref")

    def test_gmsh_has_nothing_to_complain(self):
        for extension in (".msh", ".mesh"):
            for _, _, path in self.each_mesh(extension):
                done = run(GMSH, path, "-check")
                self.assertIn("Done checking mesh coherence", done.stdout + done.stderr)
                self.assertNotRegex(done.stdout + done.stderr, "Warning|Error")

    def test_what_gmsh_saves_comes_back(self):
        """Binary files to the same bits; text has fewer digits, version 2.2 and partitions have other numbers."""
        for _, vtu, msh in self.each_mesh(".msh"):
            saved = self.folder / "saved.msh"
            for options in (("msh41", "-bin"), ("msh41",), ("msh22", "-bin"), ("msh22",), ("msh41", "-part", 3)):
                with self.subTest(options=options):
                    done = run(GMSH, msh, "-save", "-o", saved, "-format", *options)
                    self.assertNotRegex(done.stdout + done.stderr, "Warning|Error")
                    if options == ("msh41", "-bin"):
                        self.expect_same(saved, msh)
                    mesh = tissues_of(read(convert(saved, self.folder / "saved.vtu")), "label")
                    expected = tissues_of(read(vtu), "label")
                    np.testing.assert_array_equal(mesh.labels, expected.labels)
                    self.expect_volumes(mesh.tissue_volumes(), expected.tissue_volumes())
                    if options in (("msh41", "-bin"), ("msh41",)):
                        np.testing.assert_array_equal(mesh.tets, expected.tets)
                        np.testing.assert_allclose(mesh.points, expected.points, rtol=1e-14)

    def test_gmsh_keeps_the_groups_of_all_tissues(self):
        for _, vtu, msh in self.each_mesh(".msh"):
            saved = self.folder / "volumes.msh"
            run(GMSH, msh, "-save", "-o", saved, "-format", "msh41")
            mesh = read(saved)
            self.expect_volumes(tissues_of(mesh, "gmsh:physical").tissue_volumes(), checked_volumes_mm3(vtu))
            self.assertEqual(set(mesh.field_data), set(read(msh).field_data))

    def test_what_meshio_writes_is_read(self):
        """meshio keeps the tag of a block only, so that each label needs one."""
        for _, vtu, _ in self.each_mesh(".msh"):
            mesh = tissues_of(read(vtu), "label")
            tets, labels = mesh.tets, mesh.labels
            blocks = [("tetra", tets[labels == label]) for label in np.unique(labels)]
            tags = [np.full(len(block), label, np.int32) for (_, block), label in zip(blocks, np.unique(labels))]
            places = np.zeros((len(mesh.points), 2), np.int32)
            places[tets] = np.stack([np.full(len(labels), 3), labels], axis=1)[:, np.newaxis]
            gmsh = meshio.Mesh(mesh.points, blocks, {"gmsh:dim_tags": places},
                               {"gmsh:physical": tags, "gmsh:geometrical": tags})
            medit = meshio.Mesh(mesh.points, blocks, cell_data={"medit:ref": tags})
            for name, written, options in (("a.msh", gmsh, {"file_format": "gmsh", "binary": True}),
                                           ("b.msh", gmsh, {"file_format": "gmsh", "binary": False}),
                                           ("c.msh", gmsh, {"file_format": "gmsh22", "binary": True}),
                                           ("d.msh", gmsh, {"file_format": "gmsh22", "binary": False}),
                                           ("e.mesh", medit, {"float_fmt": ".16e"})):
                with self.subTest(file=name):
                    write(self.folder / name, written, **options)
                    found = read(convert(self.folder / name, self.folder / "found.vtu"))
                    np.testing.assert_array_equal(found.points, mesh.points)
                    np.testing.assert_array_equal(found.cells[0].data, tets)
                    np.testing.assert_array_equal(found.cell_data["label"][0], labels)

    def test_names_come_back(self):
        in_gmsh = {3: "White matter", 200: "Große _Vene_", 7: "x" * 120}
        for extension, names in ((".msh", in_gmsh), (".mesh", NAMES)):
            copy = convert(convert(self.named, self.folder / f"copy{extension}"), self.folder / "copy.mesh")
            comments = [line for line in copy.read_text().splitlines() if line.startswith("# label")]
            self.assertEqual(comments, [f"# label {label} {name}" for label, name in sorted(names.items())])


if __name__ == "__main__":
    run_tests()
