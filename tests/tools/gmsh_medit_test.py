#!/usr/bin/env python3
"""Gmsh and meshio read the .msh and .mesh files of `anatomesh`, and `anatomesh` reads theirs.

usage: gmsh_medit_test.py ANATOMESH      exit status 77 (skipped) without numpy, meshio or gmsh
"""
import contextlib
import io
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
try:
    import meshio
    import numpy as np
    from make_vessel_tree import write_nifti
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

AAL = pathlib.Path("/usr/share/mricron/templates/aal.nii.gz")
NAMES = {3: "White matter", 200: "Große \"Vene\"", 7: "x" * 200}
FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # of a tetrahedron, opposite to each corner


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True,
                          stdin=subprocess.DEVNULL)


def convert(mesh, out):
    run(ANATOMESH, "convert", mesh, out)
    return out


def read(path):
    with contextlib.redirect_stdout(io.StringIO()):
        return meshio.read(path)


def write(path, mesh, **options):
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        mesh.write(path, **options)


def tets_and_labels(mesh, array):
    """All tetrahedra and their labels, by ascending label and else in the order of the file."""
    blocks = [(block.data, labels) for block, labels in zip(mesh.cells, mesh.cell_data[array]) if block.type == "tetra"]
    tets, labels = (np.concatenate(parts) for parts in zip(*blocks))
    order = np.argsort(labels, kind="stable")
    return tets[order], labels[order]


def volumes_mm3(points, tets, labels):
    a, b, c, d = (points[tets[:, n]] for n in range(4))
    volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    return {int(label): volumes[labels == label].sum() for label in np.unique(labels)}


def surfaces(tets, labels):
    """(inside, outside) -> faces; 0 outside the mesh."""
    faces = np.sort(np.concatenate([tets[:, face] for face in FACES]), axis=1)
    order = np.lexsort(faces.T)
    faces, sides = faces[order], np.tile(labels, 4)[order]
    is_shared = (faces[1:] == faces[:-1]).all(axis=1)
    first, last = np.append(True, ~is_shared), np.append(~is_shared, True)
    inside = np.minimum(sides[first], sides[last])
    outside = np.where(first[last], 0, np.maximum(sides[first], sides[last]))
    found = {}
    for face, low, high in zip(faces[first].tolist(), inside.tolist(), outside.tolist()):
        if low != high:
            found.setdefault((low, high), []).append(tuple(face))
    return found


def balls():
    """Two balls that touch, and a bar through one of them."""
    i, j, k = np.indices((30, 24, 24))
    voxels = np.zeros((30, 24, 24), np.uint8)
    voxels[(i - 10) ** 2 + (j - 12) ** 2 + (k - 12) ** 2 <= 64] = 3
    voxels[(i - 22) ** 2 + (j - 12) ** 2 + (k - 12) ** 2 <= 36] = 200
    voxels[5:15, 10:15, 10:15] = 7
    return voxels


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
        write_nifti(cls.folder / "balls.nii.gz", balls(), 1.3)
        images = {"balls": cls.folder / "balls.nii.gz", **({"aal": AAL} if AAL.exists() else {})}
        cls.meshes = {}
        for name, image in images.items():
            vtu = cls.folder / f"{name}.vtu"
            run(ANATOMESH, "mesh", image, "-o", vtu, "--quiet", "--bcc-size", "32" if name == "aal" else "16")
            cls.meshes[name] = vtu
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
        expected, mesh = read(vtu), read(path)
        tets, labels = tets_and_labels(mesh, array)
        expected_tets, expected_labels = tets_and_labels(expected, "label")
        np.testing.assert_array_equal(labels, expected_labels)
        np.testing.assert_array_equal(mesh.points[tets], expected.points[expected_tets])
        self.expect_checked_volumes(path, volumes_mm3(mesh.points, tets, labels))
        return mesh, tets, labels

    def expect_checked_volumes(self, path, volumes):
        report = self.folder / "check.json"
        subprocess.run([ANATOMESH, "check", path, "--no-distances", "--quiet", "--json", report], check=False,
                       capture_output=True)
        tissues = json.loads(report.read_text(encoding="utf-8"))["assessment"]["tissues"]
        self.assertEqual({tissue["label"] for tissue in tissues}, set(volumes))
        for tissue in tissues:
            self.assertAlmostEqual(tissue["quality"]["volume_mm3"] / volumes[tissue["label"]], 1, delta=1e-9)

    def expect_surfaces(self, mesh, tets, labels, array):
        """A number for each surface, of no other group; returns the pair of tissues of each."""
        expected = {frozenset(faces): pair for pair, faces in surfaces(tets, labels).items()}
        pair_of = {}
        numbered = [(block.data, tags) for block, tags in zip(mesh.cells, mesh.cell_data[array])
                    if block.type == "triangle"]
        triangles, tags = (np.concatenate(parts) for parts in zip(*numbered))
        for tag in np.unique(tags):
            faces = frozenset(tuple(sorted(face)) for face in triangles[tags == tag].tolist())
            pair_of[int(tag)] = expected.pop(faces)
        self.assertEqual(expected, {})
        self.assertFalse(set(pair_of) & set(labels.tolist()))
        return pair_of

    def test_meshio_reads_msh(self):
        for name, vtu, msh in self.each_mesh(".msh"):
            mesh, tets, labels = self.expect_same_mesh(vtu, msh, "gmsh:physical")
            pair_of = self.expect_surfaces(mesh, tets, labels, "gmsh:physical")
            groups = {(int(dimension), int(tag)): group for group, (tag, dimension) in mesh.field_data.items()}
            self.assertEqual(set(groups), {(3, int(label)) for label in labels} | {(2, tag) for tag in pair_of})
            if name == "balls":
                named = {3: "White matter", 200: "Große _Vene_", 7: "x" * 120}
                self.assertEqual({label: groups[3, label] for label in NAMES}, named)
                self.assertEqual({groups[2, tag]: pair for tag, pair in pair_of.items()},
                                 {"White matter_skin": (3, 0), "Große _Vene__skin": (200, 0),
                                  "White matter_to_Große _Vene_": (3, 200), "interface_3_7": (3, 7)})

    def test_meshio_reads_mesh(self):
        for _, vtu, path in self.each_mesh(".mesh"):
            mesh, tets, labels = self.expect_same_mesh(vtu, path, "medit:ref")
            np.testing.assert_array_equal(mesh.points, read(vtu).points)
            self.expect_surfaces(mesh, tets, labels, "medit:ref")

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
                    mesh, expected = read(convert(saved, self.folder / "saved.vtu")), read(vtu)
                    volumes, tets = self.measured(mesh, "label"), tets_and_labels(mesh, "label")[0]
                    for label, (count, volume) in self.measured(expected, "label").items():
                        self.assertEqual(volumes[label][0], count)
                        self.assertAlmostEqual(volumes[label][1] / volume, 1, delta=1e-9)
                    if options in (("msh41", "-bin"), ("msh41",)):
                        np.testing.assert_array_equal(tets, tets_and_labels(expected, "label")[0])
                        np.testing.assert_allclose(mesh.points, expected.points, rtol=1e-14)

    def measured(self, mesh, array):
        """label -> tetrahedra, volume"""
        tets, labels = tets_and_labels(mesh, array)
        volumes = volumes_mm3(mesh.points, tets, labels)
        return {label: (np.count_nonzero(labels == label), volume) for label, volume in volumes.items()}

    def test_gmsh_keeps_the_groups_of_all_tissues(self):
        for _, vtu, msh in self.each_mesh(".msh"):
            saved = self.folder / "volumes.msh"
            run(GMSH, msh, "-save", "-o", saved, "-format", "msh41")
            mesh = read(saved)
            tets, labels = tets_and_labels(mesh, "gmsh:physical")
            self.expect_checked_volumes(vtu, volumes_mm3(mesh.points, tets, labels))
            self.assertEqual(set(mesh.field_data), set(read(msh).field_data))

    def test_what_meshio_writes_is_read(self):
        """meshio keeps the tag of a block only, so that each label needs one."""
        for _, vtu, _ in self.each_mesh(".msh"):
            mesh = read(vtu)
            tets, labels = tets_and_labels(mesh, "label")
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
        for extension in (".msh", ".mesh"):
            copy = convert(convert(self.named, self.folder / f"copy{extension}"), self.folder / "copy.mesh")
            comments = [line for line in copy.read_text().splitlines() if line.startswith("# label")]
            self.assertEqual(comments, ["# label 3 White matter", f"# label 7 {'x' * 120}", "# label 200 Große _Vene_"])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    ANATOMESH = sys.argv.pop()
    GMSH = shutil.which("gmsh")
    if GMSH is None:
        print("skipped: there is no gmsh")
        sys.exit(77)
    unittest.main()
