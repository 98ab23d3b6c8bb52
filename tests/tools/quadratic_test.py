#!/usr/bin/env python3
"""Quadratic tetrahedra, as programs see them that are not ours: meshio, VTK, Gmsh, TetGen and CalculiX.

usage: quadratic_test.py ANATOMESH      exit status 77 (skipped) without numpy or meshio
"""
import pathlib
import re
import shutil
import tempfile
import unittest

from demo_meshes import anatomesh, balls, checked, convert, meshes, needed_packages, quiet, run, run_tests

with needed_packages():
    import meshio
    import numpy as np

EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))

BOX = """8 3 0 0
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
6 0
1
4 1 2 3 4
1
4 5 6 7 8
1
4 1 2 6 5
1
4 2 3 7 6
1
4 3 4 8 7
1
4 4 1 5 8
0
0
"""


def volumes(points, cells):
    """Of quadratic tetrahedra, by the four points of Gauss (exact to degree 2; the Jacobian has degree 3)."""
    near, far = (5 + 3 * 5 ** 0.5) / 20, (5 - 5 ** 0.5) / 20
    total = 0
    for n in range(4):
        share = np.full(4, far)
        share[n] = near
        slopes = np.zeros((10, 4))    # of the shape functions, by the four barycentric coordinates
        slopes[np.arange(4), np.arange(4)] = 4 * share - 1
        for edge, (a, b) in enumerate(EDGES):
            slopes[4 + edge, a], slopes[4 + edge, b] = 4 * share[b], 4 * share[a]
        directions = np.einsum("cpx,pd->cdx", points[cells], slopes[:, 1:] - slopes[:, :1])
        total = total + np.linalg.det(directions) / 24
    return total


class Quadratic(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.kept.name)
        path = meshes(cls.folder, balls(), "--bcc-size", "4", "--order", "2", extension=".vtu")["balls"]
        cls.vtu = path
        with quiet():
            mesh = meshio.read(path)
        cls.points, cls.cells = mesh.points, mesh.cells_dict["tetra10"]
        cls.labels = mesh.cell_data["label"][0]

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    def converted(self, extension):
        return convert(self.vtu, self.vtu.with_suffix(extension))

    def test_nodes_lie_near_the_middle_of_their_edges(self):
        for n, (a, b) in enumerate(EDGES):
            start, end = self.points[self.cells[:, a]], self.points[self.cells[:, b]]
            off = np.linalg.norm(self.points[self.cells[:, 4 + n]] - (start + end) / 2, axis=1)
            self.assertLess((off / np.linalg.norm(end - start, axis=1)).max(), 0.25)

    def test_meshio_finds_the_same_nodes(self):
        """In its own order of nodes, which is VTK's, whatever that of the format is."""
        for extension in (".vtk", ".msh", ".inp", ".bdf", ".xdmf"):
            with self.subTest(extension=extension), quiet():
                mesh = meshio.read(self.converted(extension))
                cells = np.concatenate([block.data for block in mesh.cells if block.type == "tetra10"])
                nodes = mesh.points[cells]
                expected = self.points[self.cells]
                order, wanted = (np.lexsort(all_nodes[:, :4].mean(axis=1).T) for all_nodes in (nodes, expected))
                np.testing.assert_allclose(nodes[order], expected[wanted], rtol=0, atol=1e-9)

    def test_balls_are_rounder(self):
        """Edge nodes on the skin of the small ball lie about as far from its middle as its corners do."""
        chords, nodes = self.skin_edges(200)
        middle = np.array([19.0, 9, 9])
        corners, nodes, flat = (np.linalg.norm(places - middle, axis=-1).mean()
                                for places in (chords, nodes, chords.mean(axis=1)))
        self.assertGreater(corners - flat, 0.05)
        self.assertLess(abs(corners - nodes), 0.25 * (corners - flat))

    def skin_edges(self, label):
        """Both ends, and the node between, of the edges on the outer skin of a tissue."""
        sides = np.sort(np.concatenate([self.cells[:, c] for c in ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))]), axis=1)
        faces, counts = np.unique(sides, axis=0, return_counts=True)
        outer = np.unique(faces[counts == 1][:, ((0, 1), (0, 2), (1, 2))].reshape(-1, 2), axis=0)
        found = {}
        for cell in self.cells[self.labels == label]:
            for n, edge in enumerate(EDGES):
                found[tuple(sorted(cell[list(edge)]))] = cell[4 + n]
        ends = [tuple(edge) for edge in outer if tuple(edge) in found]
        return self.points[np.array(ends)], self.points[[found[edge] for edge in ends]]

    @unittest.skipUnless(shutil.which("gmsh"), "Gmsh is not installed")
    def test_gmsh_reads_them(self):
        for extension in (".msh", ".mesh"):
            with self.subTest(extension=extension):
                path = self.converted(extension)
                said = run("gmsh", "-check", path)
                self.assertNotIn("Error", said.stdout + said.stderr)
                self.assertNotIn("Warning", said.stdout + said.stderr)
                again = path.with_name(f"again{extension}.msh")
                run("gmsh", path, "-save", "-o", again)
                curves, expected = (checked(mesh, "--no-distances")["curves"] for mesh in (again, self.vtu))
                self.assertEqual(curves["tets"], expected["tets"])
                self.assertAlmostEqual(curves["min_jacobian"], expected["min_jacobian"], places=6)

    @unittest.skipUnless(shutil.which("tetgen"), "TetGen is not installed")
    def test_tetgen_orders_nodes_as_we_do(self):
        """Its own quadratic tetrahedra of a box are straight; with nodes mixed up they would be folded."""
        box = self.folder / "box.poly"
        box.write_text(BOX, encoding="ascii")
        run("tetgen", "-pq1.2a0.05o2", box)
        curves = checked(self.folder / "box.1.ele", "--no-distances")["curves"]
        self.assertGreater(curves["tets"], 20)
        self.assertAlmostEqual(curves["min_jacobian"], 1)
        self.assertEqual(curves["curved_tets"], 0)

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed")
    def test_calculix_carries_the_weight(self):
        """The volumes that CalculiX integrates, and the weight as the sum of reactions on the held skin."""
        self.converted(".inp")
        density, gravity = 1e-9, 9810.0
        deck = ["*INCLUDE, INPUT=balls.inp", "*MATERIAL, NAME=M", "*ELASTIC", "0.003, 0.3", "*DENSITY", f"{density}"]
        labels = np.unique(self.labels)
        deck += [f"*SOLID SECTION, ELSET=label_{label}, MATERIAL=M" for label in labels]
        deck += ["*BOUNDARY", "label_200_skin, 1, 3", "*STEP", "*STATIC", "*DLOAD"]
        deck += [f"label_{label}, GRAV, {gravity}, 0., 0., -1." for label in labels]
        deck += ["*NODE PRINT, NSET=label_200_skin, TOTALS=ONLY", "RF"]
        for label in labels:
            deck += [f"*EL PRINT, ELSET=label_{label}, TOTALS=ONLY", "EVOL"]
        (self.folder / "deck.inp").write_text("\n".join(deck + ["*END STEP", ""]), encoding="ascii")
        run("ccx", "deck", folder=self.folder)
        text = (self.folder / "deck.dat").read_text(encoding="ascii")
        own = volumes(self.points, self.cells)
        for label, volume in re.findall(r"total volume.*set LABEL_(\d+) .*\n\n\s*(\S+)", text):
            self.assertAlmostEqual(float(volume) / own[self.labels == int(label)].sum(), 1, places=5)
        reaction = float(re.search(r"total force.*\n\n\s*\S+\s+\S+\s+(\S+)", text)[1])
        # Quadratic tetrahedra spread their weight over edge nodes: what lies on the held ones is left out.
        self.assertGreater(reaction, 0.7 * own.sum() * density * gravity)
        self.assertLess(reaction, 1.01 * own.sum() * density * gravity)

    def test_order_comes_and_goes(self):
        straight = convert(self.vtu, self.folder / "straight.vtu", "--order", "1")
        again = convert(straight, self.folder / "again.vtu", "--order", "2")
        self.assertEqual(again.read_bytes(), self.vtu.read_bytes())
        self.assertEqual(checked(straight, "--no-distances")["curves"]["tets"], 0)
        said = anatomesh("convert", straight, self.folder / "x.vtu", "--order", "3", check=False)
        self.assertEqual(said.returncode, 2)
        self.assertIn("1|2", said.stderr)


if __name__ == "__main__":
    run_tests()
