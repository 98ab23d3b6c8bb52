#!/usr/bin/env python3
"""What a mesh shows of itself, and its ways to other packages."""
import gc
import json
import pathlib
import pickle
import tempfile
import unittest

import anatomesh
import numpy as np
from support import needs, needs_program, nested_balls, oblique_left_handed, run_program, volumes

NAMES = {1: "brain", 7: "tumour α", 9: "not there"}


class Arrays(unittest.TestCase):
    def test_are_read_only_views_that_keep_the_mesh_alive(self):
        mesh = anatomesh.mesh(nested_balls())
        for name, dtype, columns in [("points", np.float64, (3,)), ("tets", np.uint32, (4,)), ("labels", np.uint32, ())]:
            with self.subTest(name):
                array = getattr(mesh, name)
                self.assertEqual((array.dtype, array.shape[1:]), (dtype, columns))
                self.assertTrue(np.shares_memory(array, getattr(mesh, name)))
                self.assertFalse(array.flags.owndata)
                self.assertFalse(array.flags.writeable)
                with self.assertRaises(ValueError):
                    array.setflags(write=True)
        points, kept = mesh.points, np.array(mesh.points)
        del mesh
        gc.collect()
        churn = [np.full(kept.shape, n, float) for n in range(20)]
        np.testing.assert_array_equal(points, kept)
        del churn

    def test_are_a_mesh(self):
        mesh = anatomesh.mesh(nested_balls(), spacing=(1, 1, 1.5))
        self.assertEqual(len(mesh.labels), len(mesh.tets))
        self.assertLess(mesh.tets.max(), len(mesh.points))
        self.assertGreater(volumes(mesh).min(), 0)
        for label in (1, 7):
            wanted = 1.5 * np.count_nonzero(nested_balls() == label)
            self.assertAlmostEqual(volumes(mesh)[mesh.labels == label].sum() / wanted, 1, delta=0.02)

    def test_of_another_mesh_can_be_given(self):
        points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        mesh = anatomesh.Mesh(points, [[0, 1, 2, 3]], [5], {5: "x"})
        np.testing.assert_array_equal(mesh.points, points)
        self.assertEqual((mesh.labels.tolist(), mesh.names, mesh.tissues), ([5], {5: "x"}, {}))
        self.assertEqual(anatomesh.Mesh(points, [[0, 1, 2, 3]]).labels.tolist(), [1])
        self.assertAlmostEqual(mesh.assess()["whole"]["quality"]["volume_mm3"], 1 / 6)
        for arguments, message in [
            ((points, [[0, 1, 2, 4]]), "has the vertex 4 of a mesh of 4 points"),
            ((points, [[0, 1, 2]]), r"tets is an array of shape \(1, 3\); it must be \(n, 4\)"),
            ((points[:, :2], [[0, 1, 2, 3]]), r"points is an array of shape \(4, 2\); it must be \(n, 3\)"),
            ((points, [[0, 1, 2, 3]], [1, 2]), "2 labels for 1 tetrahedra"),
            ((points, [[0, 1, 2, 3]], [-1]), "labels holds other than whole numbers"),
            ((points, [[0, 1, 2, 3.5]]), "tets holds other than whole numbers"),
        ]:
            with self.subTest(message), self.assertRaisesRegex(anatomesh.InvalidInput, message):
                anatomesh.Mesh(*arguments)


class Description(unittest.TestCase):
    mesh = anatomesh.mesh(nested_balls(), names=NAMES)

    def test_says_what_became_of_the_tissues(self):
        self.assertEqual(list(self.mesh.tissues), [1, 7])
        for label, tissue in self.mesh.tissues.items():
            self.assertEqual(tissue.label, label)
            self.assertEqual(tissue.voxels, np.count_nonzero(nested_balls() == label))
            self.assertEqual(tissue.tets, np.count_nonzero(self.mesh.labels == label))
            self.assertEqual(tissue.fidelity, 0.95)
            self.assertGreater(min(tissue.f1, tissue.f2), 0.9)

    def test_says_names_times_warnings_and_options(self):
        self.assertEqual(self.mesh.names, {1: "brain", 7: "tumour α"})
        self.assertIn("deform", self.mesh.times)
        self.assertGreater(sum(self.mesh.times.values()), 0)
        self.assertGreater(self.mesh.options["bcc_size_mm"], 0)
        dropped = nested_balls()
        dropped[0, 0, 0] = 7
        (warning, *_) = anatomesh.mesh(dropped, drop_islands=2).warnings
        self.assertIn("island", warning)
        self.assertRegex(repr(self.mesh), r"<anatomesh\.Mesh: \d+ vertices, \d+ tetrahedra, 2 labels>")

    def test_names_are_lines_of_text(self):
        with self.assertRaisesRegex(anatomesh.InvalidInput, "name of label 7 goes over several lines"):
            anatomesh.mesh(nested_balls(), names={7: "a\nb"})
        with self.assertRaisesRegex(anatomesh.InvalidInput, "name of label 7 is 3; it must be text"):
            anatomesh.mesh(nested_balls(), names={7: 3})

    def test_can_be_pickled(self):
        again = pickle.loads(pickle.dumps(self.mesh))
        for name in ("points", "tets", "labels"):
            np.testing.assert_array_equal(getattr(again, name), getattr(self.mesh, name))
        for name in ("names", "tissues", "warnings", "times", "options"):
            self.assertEqual(getattr(again, name), getattr(self.mesh, name))


class Interfaces(unittest.TestCase):
    def test_enclose_the_tissues(self):
        mesh = anatomesh.mesh(nested_balls())
        surfaces = {(s.inside, s.outside): s for s in mesh.interfaces()}
        self.assertEqual(set(surfaces), {(1, 0), (1, 7)})
        enclosed = {}
        for key, surface in surfaces.items():
            a, b, c = (mesh.points[surface.triangles[:, n]] for n in range(3))
            enclosed[key] = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
            self.assertTrue((mesh.labels[surface.tets] == surface.inside).all())
            corner = mesh.tets[surface.tets, surface.opposite]
            self.assertFalse((surface.triangles == corner[:, np.newaxis]).any())
        of_label = {label: volumes(mesh)[mesh.labels == label].sum() for label in (1, 7)}
        self.assertAlmostEqual(enclosed[1, 0], of_label[1] + of_label[7], places=6)
        self.assertAlmostEqual(-enclosed[1, 7], of_label[7], places=6)  # seen from the shell, the core lies outside


class Assess(unittest.TestCase):
    @needs("meshio", "nibabel")
    @needs_program
    def test_says_what_the_command_line_says(self):
        import nibabel

        with tempfile.TemporaryDirectory() as folder:
            image, mesh_file, report = (pathlib.Path(folder, name) for name in ("i.nii.gz", "m.vtu", "r.json"))
            nibabel.save(nibabel.Nifti1Image(nested_balls(), oblique_left_handed()), image)
            run_program("mesh", image, "-o", mesh_file)
            mesh = anatomesh.mesh_image(nibabel.load(image))
            for given in ([], ["--image", image]):
                with self.subTest(given):
                    run_program("check", mesh_file, *given, "--json", report)
                    wanted = json.loads(report.read_text())
                    measured = mesh.assess(nibabel.load(image) if given else None)
                    self.assertEqual(measured.pop("failed_guarantees"), wanted["failed_guarantees"])
                    self.assertEqual(measured, wanted["assessment"])

    def test_looks_at_the_labels_and_bounds_that_were_asked_for(self):
        voxels = nested_balls()
        mesh = anatomesh.mesh(voxels, labels=[7], min_dihedral_deg=10)
        self.assertEqual(mesh.assess(voxels, distances=False)["failed_guarantees"], [])
        every = mesh.assess(voxels, distances=False, labels=[1, 7])
        self.assertEqual(every["summary"]["missing_labels"], [1])
        self.assertNotEqual(mesh.assess(min_dihedral_deg=30)["failed_guarantees"], [])
        self.assertIsNone(mesh.assess()["whole"]["fidelity"])
        self.assertFalse(every["has_distances"])


class OtherPackages(unittest.TestCase):
    mesh = anatomesh.mesh(nested_balls(), names=NAMES)

    @needs("meshio")
    def test_meshio_and_back(self):
        import meshio

        again = anatomesh.Mesh.from_meshio(self.mesh.to_meshio())
        for name in ("points", "tets", "labels", "names"):
            np.testing.assert_array_equal(getattr(again, name), getattr(self.mesh, name))
        for extension in (".vtu", ".vtk", ".msh", ".mesh", ".inp"):
            with self.subTest(extension), tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder, "mesh" + extension)
                self.mesh.to_meshio().write(file)
                read = anatomesh.Mesh.from_meshio(meshio.read(file))
                np.testing.assert_allclose(read.points, self.mesh.points)
                np.testing.assert_array_equal(read.tets, self.mesh.tets)

    @needs("meshio")
    def test_meshio_with_other_cells_and_arrays(self):
        import meshio

        points = np.random.default_rng(1).random((6, 3))
        mesh = meshio.Mesh(
            points,
            [("triangle", [[0, 1, 2]]), ("tetra", [[0, 1, 2, 3]]), ("tetra", [[1, 2, 3, 4], [2, 3, 4, 5]])],
            cell_data={"gmsh:physical": [[9], [4], [5, 6]], "x": [[1], [1], [2, 3]]},
        )
        self.assertEqual(anatomesh.Mesh.from_meshio(mesh).labels.tolist(), [4, 5, 6])
        self.assertEqual(anatomesh.Mesh.from_meshio(mesh, label="x").labels.tolist(), [1, 2, 3])
        with self.assertRaisesRegex(anatomesh.InvalidInput, r"no cell data 'y'; it has \['gmsh:physical', 'x'\]"):
            anatomesh.Mesh.from_meshio(mesh, label="y")
        with self.assertRaisesRegex(anatomesh.InvalidInput, "neither of the cells"):
            anatomesh.Mesh.from_meshio(meshio.Mesh(points, [("triangle", [[0, 1, 2]])]))

    @needs("pyvista")
    def test_pyvista(self):
        grid = self.mesh.to_pyvista()
        self.assertEqual(grid.n_cells, len(self.mesh.tets))
        np.testing.assert_array_equal(grid.points, self.mesh.points)
        np.testing.assert_array_equal(grid.cell_data["label"], self.mesh.labels)
        names = grid.GetFieldData().GetAbstractArray("label_names")
        self.assertEqual([names.GetValue(n) for n in range(2)], list(self.mesh.names.values()))
        self.assertEqual(grid.field_data["label_values"].tolist(), list(self.mesh.names))
        self.assertAlmostEqual(grid.volume, volumes(self.mesh).sum(), places=3)


if __name__ == "__main__":
    unittest.main()
