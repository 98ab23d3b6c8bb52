#!/usr/bin/env python3
"""Quadratic tetrahedra on their way through the package."""
import pathlib
import pickle
import tempfile
import unittest

import anatomesh
import numpy as np
from support import needs, needs_program, nested_balls, run_program


class Quadratic(unittest.TestCase):
    linear = anatomesh.mesh(nested_balls())
    mesh = anatomesh.mesh(nested_balls(), order=2)

    def test_has_the_corners_of_the_linear_mesh(self):
        self.assertEqual((self.linear.order, self.mesh.order), (1, 2))
        self.assertEqual(self.linear.edge_nodes.shape, (0, 6))
        np.testing.assert_array_equal(self.mesh.tets, self.linear.tets)
        np.testing.assert_array_equal(self.mesh.points[: len(self.linear.points)], self.linear.points)
        np.testing.assert_array_equal(self.mesh.cells, np.hstack([self.mesh.tets, self.mesh.edge_nodes]))
        self.assertFalse(self.mesh.edge_nodes.flags.writeable)

    def test_comes_of_a_linear_mesh_and_goes(self):
        again = self.linear.with_order(2)
        np.testing.assert_array_equal(again.points, self.mesh.points)
        np.testing.assert_array_equal(again.edge_nodes, self.mesh.edge_nodes)
        self.assertEqual((again.tissues, again.options["order"]), (self.linear.tissues, 2))
        np.testing.assert_array_equal(again.with_order(1).points, self.linear.points)
        with self.assertRaisesRegex(ValueError, "order is 3; it must be 1 or 2"):
            self.linear.with_order(3)
        with self.assertRaisesRegex(anatomesh.InvalidOption, "order is 0"):
            anatomesh.mesh(nested_balls(), order=0)

    def test_keeps_the_bounds_at_its_corners(self):
        report = self.mesh.assess(distances=False)
        self.assertEqual(report["failed_guarantees"], [])
        self.assertEqual(report["curves"]["tets"], len(self.mesh.tets))
        self.assertGreater(report["curves"]["curved_tets"], len(self.mesh.tets) / 4)
        self.assertGreaterEqual(report["curves"]["min_jacobian"], 0.3)
        self.assertIsNone(self.linear.assess(distances=False)["curves"]["min_jacobian"])

    def test_follows_the_changes_of_its_image(self):
        voxels = nested_balls()
        mesher = anatomesh.Remesher(voxels, order=2)
        voxels[12, 14, 12] = 1
        mesher.update(voxels)
        self.assertEqual(mesher.mesh.assess(distances=False)["failed_guarantees"], [])
        self.assertEqual(mesher.mesh.order, 2)

    def test_can_be_given_and_pickled(self):
        mesh = anatomesh.Mesh(self.mesh.points, self.mesh.tets, self.mesh.labels, edge_nodes=self.mesh.edge_nodes)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(mesh)).edge_nodes, self.mesh.edge_nodes)
        with self.assertRaisesRegex(anatomesh.InvalidInput, "edge nodes of 1 tetrahedra"):
            anatomesh.Mesh(mesh.points, mesh.tets, mesh.labels, edge_nodes=mesh.edge_nodes[:1])
        with self.assertRaisesRegex(anatomesh.InvalidInput, "the edge node 4000000000"):
            anatomesh.Mesh(mesh.points, mesh.tets, edge_nodes=np.full(mesh.edge_nodes.shape, 4000000000))

    @needs("meshio")
    @needs_program
    def test_comes_through_meshio(self):
        import meshio

        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "mesh.vtu"
            self.mesh.to_meshio().write(path)
            run_program("check", path, "--no-distances")
            read = anatomesh.Mesh.from_meshio(meshio.read(path))
        np.testing.assert_array_equal(read.edge_nodes, self.mesh.edge_nodes)
        np.testing.assert_array_equal(read.labels, self.mesh.labels)

    @needs("pyvista")
    def test_is_a_grid_of_quadratic_cells(self):
        grid = self.mesh.to_pyvista()
        self.assertEqual(set(grid.celltypes), {24})
        self.assertEqual(grid.n_cells, len(self.mesh.tets))


if __name__ == "__main__":
    unittest.main()
