#!/usr/bin/env python3
"""DOLFINx and legacy DOLFIN read the XDMF files, and DOLFINx solves linear elasticity with a stiffness per tissue.

usage: fenics_test.py ANATOMESH      exit status 77 (skipped) without numpy, or without either DOLFIN
"""
import logging
import pathlib
import tempfile
import unittest

from demo_meshes import checked_volumes_mm3, convert, meshes, nested_balls, run_tests, skip

import numpy as np    # it is there: demo_meshes needs it
try:
    import dolfinx
    import ufl
    from dolfinx.fem.petsc import LinearProblem
    from mpi4py import MPI
except ImportError:
    dolfinx = None
try:
    import dolfin
except ImportError:
    dolfin = None
if not dolfinx and not dolfin:
    skip("neither DOLFINx nor DOLFIN is installed")

POISSON = 0.3


def read_xdmf(path):
    """The mesh, its tissues and its interfaces, as DOLFINx's own tutorial reads them."""
    with dolfinx.io.XDMFFile(MPI.COMM_WORLD, str(path), "r") as file:
        mesh = file.read_mesh(name="mesh")
        tissues = file.read_meshtags(mesh, name="mesh")
    mesh.topology.create_connectivity(2, 3)
    mesh.topology.create_connectivity(2, 0)
    with dolfinx.io.XDMFFile(MPI.COMM_WORLD, str(path.with_name(path.stem + "_facets.xdmf")), "r") as file:
        return mesh, tissues, file.read_meshtags(mesh, name="facets")


def per_tissue(mesh, tissues, value_of):
    """A field that is constant in each tissue."""
    field = dolfinx.fem.Function(dolfinx.fem.FunctionSpace(mesh, ("DG", 0)))
    field.x.array[tissues.indices] = [value_of(label) for label in tissues.values]
    return field


def stress(u, young):
    strain = ufl.sym(ufl.grad(u))
    mu, lame = young / (2 * (1 + POISSON)), young * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    return 2 * mu * strain + lame * ufl.tr(strain) * ufl.Identity(3)


def solve(space, young, load, condition):
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    stiffness = ufl.inner(stress(u, young), ufl.sym(ufl.grad(v))) * ufl.dx
    problem = LinearProblem(stiffness, ufl.inner(load, v) * ufl.dx, [condition],
                            petsc_options={"ksp_type": "preonly", "pc_type": "lu"})
    return problem.solve()


def assembled(form):
    return dolfinx.fem.assemble_scalar(dolfinx.fem.form(form))


def exterior_facets(mesh):
    return dolfinx.mesh.exterior_facet_indices(mesh.topology)


@unittest.skipUnless(dolfinx, "no DOLFINx")
class Dolfinx(unittest.TestCase):
    def test_tissues_have_their_volumes(self):
        for path in MESHES:
            mesh, tissues, _ = read_xdmf(path.with_suffix(".xdmf"))
            dx = ufl.Measure("dx", domain=mesh, subdomain_data=tissues)
            one = dolfinx.fem.Constant(mesh, 1.0)
            for label, volume in list(checked_volumes_mm3(path).items())[:5]:
                with self.subTest(mesh=path.name, label=label):
                    self.assertAlmostEqual(assembled(one * dx(label)) / volume, 1, delta=1e-9)

    def test_skin_is_tagged(self):
        for path in MESHES:
            mesh, _, interfaces = read_xdmf(path.with_suffix(".xdmf"))
            self.assertTrue(np.isin(exterior_facets(mesh), interfaces.indices).all())
            self.assertGreater(len(interfaces.indices), len(exterior_facets(mesh)))

    # A stiffness and a density per tissue, held at the interface of the two: what holds it carries the weight.
    def test_reaction_is_the_weight(self):
        mesh, tissues, interfaces = read_xdmf(MESHES[0].with_suffix(".xdmf"))
        space = dolfinx.fem.VectorFunctionSpace(mesh, ("Lagrange", 1))
        young = per_tissue(mesh, tissues, {2: 5.0, 7: 80.0}.get)
        density = per_tissue(mesh, tissues, {2: 1e-3, 7: 3e-3}.get)
        between = interfaces.indices[np.isin(interfaces.indices, exterior_facets(mesh), invert=True)]
        held = dolfinx.fem.locate_dofs_topological(space, 2, between)
        condition = dolfinx.fem.dirichletbc(np.zeros(3), held, space)
        u = solve(space, young, density * ufl.as_vector((0, 0, -9.81)), condition)
        virtual = dolfinx.fem.Function(space)       # moves what is held, and only it, by 1 along z
        virtual.x.array.reshape(-1, 3)[held, 2] = 1
        load = ufl.inner(density * ufl.as_vector((0, 0, -9.81)), virtual) * ufl.dx
        reaction = assembled(ufl.inner(stress(u, young), ufl.sym(ufl.grad(virtual))) * ufl.dx) - assembled(load)
        volume = checked_volumes_mm3(MESHES[0])
        self.assertAlmostEqual(reaction / (9.81 * (1e-3 * volume[2] + 3e-3 * volume[7])), 1, delta=1e-8)
        self.assertGreater(np.abs(u.x.array).max(), 0)

    # Displacements that are linear in space, put on the skin, are those inside.
    def test_patch(self):
        mesh, _, _ = read_xdmf(MESHES[0].with_suffix(".xdmf"))
        space = dolfinx.fem.VectorFunctionSpace(mesh, ("Lagrange", 1))
        gradient = np.array([[1e-3, 2e-3, 0], [-1e-3, 3e-3, 1e-3], [0, 2e-3, -2e-3]])
        exact = dolfinx.fem.Function(space)
        exact.interpolate(lambda x: gradient @ x)
        held = dolfinx.fem.locate_dofs_topological(space, 2, exterior_facets(mesh))
        u = solve(space, 5.0, dolfinx.fem.Constant(mesh, np.zeros(3)), dolfinx.fem.dirichletbc(exact, held))
        np.testing.assert_allclose(u.x.array, exact.x.array, atol=1e-10)


@unittest.skipUnless(dolfin, "no legacy DOLFIN")
class Dolfin(unittest.TestCase):
    def test_tissues_and_interfaces(self):
        dolfin.set_log_level(40)
        path = MESHES[0].with_suffix(".xdmf")
        mesh = dolfin.Mesh()
        with dolfin.XDMFFile(str(path)) as file:
            file.read(mesh)
            labels = dolfin.MeshValueCollection("size_t", mesh, 3)
            file.read(labels, "label")
        with dolfin.XDMFFile(str(path.with_name(path.stem + "_facets.xdmf"))) as file:
            interface = dolfin.MeshValueCollection("size_t", mesh, 2)
            file.read(interface, "interface")
        tissues = dolfin.MeshFunction("size_t", mesh, labels)
        dx = dolfin.Measure("dx", domain=mesh, subdomain_data=tissues)
        for label, volume in checked_volumes_mm3(MESHES[0]).items():
            self.assertAlmostEqual(dolfin.assemble(dolfin.Constant(1) * dx(label)) / volume, 1, delta=1e-9)
        tags = dolfin.MeshFunction("size_t", mesh, interface).array()
        self.assertEqual(set(tags[tags < 1000]), {1, 2})    # 2 and 7 meet, and 7's skin
        skin = dolfin.BoundaryMesh(mesh, "exterior", True).num_cells()
        self.assertEqual(skin, np.count_nonzero((tags < 1000) & (tags == 2)))


if __name__ == "__main__":
    logging.disable(logging.WARNING)    # of the compiler of forms
    with tempfile.TemporaryDirectory() as place:
        MESHES = list(meshes(pathlib.Path(place), nested_balls()).values())
        for mesh_path in MESHES:
            convert(mesh_path, mesh_path.with_suffix(".xdmf"))
        run_tests(warnings="ignore")
