#!/usr/bin/env python3
"""Arrays of any type and order, in any place; images of SimpleITK and nibabel."""
import pathlib
import tempfile
import unittest

import anatomesh
import numpy as np
from support import (centroid, needs, needs_program, nested_balls, oblique_left_handed, run_program, volumes)

COARSE = {"fidelity": 0.8}


def same(one, other):
    """To the last bit."""
    return all(getattr(one, name).tobytes() == getattr(other, name).tobytes() for name in ("points", "tets", "labels"))


def program_mesh(image, *options):
    """What the command line makes of an image file, read by meshio."""
    import meshio

    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "mesh.vtu")
        run_program("mesh", image, "-o", file, "--quiet", *options)
        read = meshio.read(file)
    (cells,) = read.cells
    return np.asarray(read.points), np.asarray(cells.data), np.asarray(read.cell_data["label"][0])


class Voxels(unittest.TestCase):
    wanted = anatomesh.mesh(nested_balls(), **COARSE)

    def test_may_be_of_any_type_that_holds_labels(self):
        for dtype in "u1 u2 u4 u8 i1 i2 i4 i8 f2 f4 f8 >u2 >i4 >f8 <u4".split():
            with self.subTest(dtype):
                self.assertTrue(same(anatomesh.mesh(nested_balls(dtype=dtype), **COARSE), self.wanted))
        self.assertEqual(set(anatomesh.mesh(nested_balls() > 0, **COARSE).labels), {1})

    def test_may_lie_in_memory_in_any_order(self):
        voxels = nested_balls(dtype=np.int16)
        wide = np.zeros([2 * n for n in voxels.shape], np.int16)
        wide[::2, ::2, ::2] = voxels
        unaligned = np.zeros(voxels.nbytes + 1, np.uint8)[1:].view(np.int16).reshape(voxels.shape)
        unaligned[...] = voxels
        orders = {
            "Fortran": np.asfortranarray(voxels),
            "every other voxel": wide[::2, ::2, ::2],
            "backwards": voxels[::-1, ::-1, ::-1].copy()[::-1, ::-1, ::-1],
            "axes swapped": voxels.transpose(1, 2, 0).copy().transpose(2, 0, 1),
            "unaligned": unaligned,
            "four axes": voxels[..., np.newaxis],
            "lists": voxels.tolist(),
        }
        for name, array in orders.items():
            with self.subTest(name):
                self.assertTrue(same(anatomesh.mesh(array, **COARSE), self.wanted))

    def test_keep_the_largest_labels(self):
        for dtype in (np.uint32, np.int64, np.float64):
            voxels = nested_balls(dtype=dtype)
            voxels[voxels == 7] = 2**32 - 1
            self.assertEqual(set(anatomesh.mesh(voxels, **COARSE).labels), {1, 2**32 - 1})

    def test_that_are_no_labels_are_named(self):
        cases = [(-1, np.int8, "-1"), (2**32, np.int64, "4294967296"), (2**32, np.uint64, "4294967296"),
                 (0.5, np.float32, r"0\.5"), (np.nan, np.float64, "nan"), (2**32, np.float32, r"4294967296|4\.29"),
                 (np.inf, np.float64, "inf")]
        for value, dtype, text in cases:
            voxels = nested_balls(dtype=dtype)
            voxels[3, 4, 5] = value
            with self.subTest(value), self.assertRaisesRegex(
                anatomesh.InvalidInput, rf"voxel \[3, 4, 5\] is ({text}).*; labels are whole numbers from 0"
            ):
                anatomesh.mesh(voxels)

    def test_need_three_axes_and_numbers(self):
        for array, message in [
            (nested_balls()[0], "has 2 axes; three are needed"),
            (np.zeros((3, 3, 3, 2)), "has 4 axes"),
            (np.zeros((3, 3, 3), complex), "of type complex128; integers of 8 to 64 bits"),
            (np.full((3, 3, 3), "a"), "of type <U1"),
            (np.zeros((0, 3, 3), int), "no voxels along axis 0"),
            (np.zeros((3, 3, 3), int), "background"),
        ]:
            with self.subTest(message), self.assertRaisesRegex(anatomesh.InvalidInput, message):
                anatomesh.mesh(array)


class Place(unittest.TestCase):
    def test_of_an_oblique_left_handed_affine(self):
        affine, voxels = oblique_left_handed(), nested_balls()
        ras = anatomesh.mesh(voxels, affine=affine, frame="ras", fidelity=0.95)
        self.assertGreater(volumes(ras).min(), 0)
        for label in (1, 7):
            middle = np.argwhere(voxels == label).mean(axis=0)
            np.testing.assert_allclose(centroid(ras, label), affine[:3, :3] @ middle + affine[:3, 3], atol=0.1)
        self.assertEqual(ras.assess(voxels, affine=affine)["failed_guarantees"], [])

        lps = anatomesh.mesh(voxels, affine=affine, fidelity=0.95)
        np.testing.assert_allclose(lps.points * [-1, -1, 1], ras.points, atol=1e-9)

    def test_is_the_same_by_affine_and_by_spacing_origin_direction(self):
        affine = oblique_left_handed()
        spacing = np.linalg.norm(affine[:3, :3], axis=0)
        lps = np.diag([-1, -1, 1])
        by_parts = anatomesh.mesh(
            nested_balls(), spacing=spacing, origin=lps @ affine[:3, 3], direction=lps @ affine[:3, :3] / spacing
        )
        by_affine = anatomesh.mesh(nested_balls(), affine=affine)
        np.testing.assert_array_equal(by_parts.tets, by_affine.tets)
        np.testing.assert_allclose(by_parts.points, by_affine.points, atol=1e-9)

        flat = anatomesh.mesh(
            nested_balls(), spacing=list(spacing), origin=tuple(lps @ affine[:3, 3]),
            direction=(lps @ affine[:3, :3] / spacing).ravel(),
        )
        self.assertTrue(same(flat, by_parts))

    def test_that_cannot_be_is_refused(self):
        sheared = np.eye(4)
        sheared[0, 1] = 0.3
        cases = [
            ({"spacing": (1, 2)}, r"spacing has the shape \(2,\); it must be \(3,\)"),
            ({"spacing": "wide"}, "spacing is 'wide'; it must be an array of numbers"),
            ({"spacing": (1, -1, 1)}, "spacing along axis 1 is -1"),
            ({"origin": (0, np.nan, 0)}, "origin along axis 1"),
            ({"direction": np.ones((3, 3))}, "direction matrix"),
            ({"direction": np.eye(4)}, "direction has the shape"),
            ({"affine": np.eye(3)}, r"affine has the shape \(3, 3\)"),
            ({"affine": sheared}, "direction matrix"),
            ({"affine": np.zeros((4, 4))}, "last row of affine"),
            ({"affine": np.diag([0, 1, 1, 1])}, "columns of affine have the lengths"),
            ({"affine": np.eye(4), "spacing": (1, 1, 1)}, "affine is given along with spacing"),
        ]
        for geometry, message in cases:
            with self.subTest(message), self.assertRaisesRegex(anatomesh.InvalidInput, message):
                anatomesh.mesh(nested_balls(), **geometry)


class Nibabel(unittest.TestCase):
    def image(self, affine, voxels=None):
        import nibabel

        return nibabel.Nifti1Image(nested_balls() if voxels is None else voxels, affine)

    @needs("nibabel")
    def test_image_lies_where_its_affine_says(self):
        affine = oblique_left_handed()
        self.assertTrue(same(anatomesh.mesh_image(self.image(affine)), anatomesh.mesh(nested_balls(), affine=affine)))

    @needs("nibabel", "meshio")
    @needs_program
    def test_file_gives_the_bytes_of_the_command_line(self):
        import nibabel

        for name, affine in [("oblique", oblique_left_handed()), ("straight", np.diag([0.7, 0.8, 1.1, 1.0]))]:
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder, "image.nii.gz")
                nibabel.save(self.image(affine), file)
                mesh = anatomesh.mesh_image(nibabel.load(file), fidelity=0.97, size_label={1: 4}, frame="ras")
                points, tets, labels = program_mesh(file, "--fidelity", 0.97, "--size-label", "1=4", "--frame", "ras")
                self.assertEqual(points.tobytes(), mesh.points.tobytes())
                np.testing.assert_array_equal(tets, mesh.tets)
                np.testing.assert_array_equal(labels, mesh.labels)

    @needs("nibabel")
    def test_units_and_sheared_sforms_are_minded(self):
        microns = self.image(np.diag([800, 800, 900, 1]))
        microns.header.set_xyzt_units("micron")
        self.assertTrue(same(anatomesh.mesh_image(microns), anatomesh.mesh(nested_balls(), affine=np.diag([0.8, 0.8, 0.9, 1]))))

        sheared = np.eye(4)
        sheared[0, 1] = 0.3
        image = self.image(np.eye(4))
        image.set_qform(np.eye(4), 1)
        image.set_sform(sheared, 2)
        self.assertTrue(same(anatomesh.mesh_image(image), anatomesh.mesh(nested_balls(), affine=np.eye(4))))
        image.set_qform(None, 0)
        with self.assertRaisesRegex(anatomesh.InvalidInput, "direction matrix"):
            anatomesh.mesh_image(image)

    @needs("nibabel")
    def test_image_that_is_scaled_or_of_four_axes_is_read(self):
        wanted = anatomesh.mesh(nested_balls(), affine=np.eye(4))
        self.assertTrue(same(anatomesh.mesh_image(self.image(np.eye(4), nested_balls()[..., np.newaxis])), wanted))


class SimpleItk(unittest.TestCase):
    lps = np.diag([-1, -1, 1, 1]) @ oblique_left_handed()
    spacing, origin = (0.8, 1.0, 1.3), lps[:3, 3]
    direction = lps[:3, :3] / spacing

    def image(self):
        import SimpleITK

        image = SimpleITK.GetImageFromArray(np.ascontiguousarray(nested_balls().T))
        image.SetSpacing(self.spacing)
        image.SetOrigin(self.origin)
        image.SetDirection(self.direction.ravel())
        return image

    @needs("SimpleITK")
    def test_image_lies_where_it_says(self):
        wanted = anatomesh.mesh(nested_balls(), spacing=self.spacing, origin=self.origin, direction=self.direction)
        self.assertTrue(same(anatomesh.mesh_image(self.image()), wanted))
        self.assertTrue(same(anatomesh.mesh(self.image()), wanted))

    @needs("SimpleITK", "meshio")
    @needs_program
    def test_file_gives_the_bytes_of_the_command_line(self):
        import SimpleITK

        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "image.nrrd")
            SimpleITK.WriteImage(self.image(), str(file))
            mesh = anatomesh.mesh_image(SimpleITK.ReadImage(str(file)), max_elements=3000)
            points, tets, labels = program_mesh(file, "--max-elements", 3000)
        self.assertEqual(points.tobytes(), mesh.points.tobytes())
        np.testing.assert_array_equal(tets, mesh.tets)
        np.testing.assert_array_equal(labels, mesh.labels)

    @needs("SimpleITK")
    def test_image_of_two_dimensions_is_refused(self):
        import SimpleITK

        with self.assertRaisesRegex(anatomesh.InvalidInput, "has 2 dimensions; 3 are needed"):
            anatomesh.mesh_image(SimpleITK.Image(4, 4, SimpleITK.sitkUInt8))

    @needs("SimpleITK")
    def test_image_takes_no_other_geometry(self):
        with self.assertRaisesRegex(anatomesh.InvalidInput, "a Image says itself where it lies"):
            anatomesh.mesh(self.image(), spacing=(1, 1, 1))


class MeshImage(unittest.TestCase):
    def test_refuses_arrays(self):
        with self.assertRaisesRegex(TypeError, r"ndarray is neither a SimpleITK\.Image nor .* give arrays to mesh\(\)"):
            anatomesh.mesh_image(nested_balls())


if __name__ == "__main__":
    unittest.main()
