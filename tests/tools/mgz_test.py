#!/usr/bin/env python3
"""FreeSurfer volumes as nibabel writes them: the same place and labels as nibabel's NIfTI file of the same image.

usage: mgz_test.py ANATOMESH      exit status 77 (skipped) without numpy or nibabel
"""
import pathlib
import tempfile
import unittest

from demo_meshes import anatomesh, needed_packages, run_tests

with needed_packages():
    import nibabel
    import numpy

SIZE = (13, 11, 9)
TYPES = ("u1", "i2", "i4", "f4")


def rotation():
    """An oblique one."""
    a, b = 0.3, -0.5
    about_x = [[1, 0, 0], [0, numpy.cos(a), -numpy.sin(a)], [0, numpy.sin(a), numpy.cos(a)]]
    about_z = [[numpy.cos(b), -numpy.sin(b), 0], [numpy.sin(b), numpy.cos(b), 0], [0, 0, 1]]
    return numpy.array(about_x) @ numpy.array(about_z)


def affine(direction):
    matrix = numpy.eye(4)
    matrix[:3, :3] = direction @ numpy.diag([1.25, 0.75, 2])
    matrix[:3, 3] = [11, -22, 33]
    return matrix


PLACES = {"ras": affine(numpy.eye(3)),
          "freesurfer": affine(numpy.array([[-1, 0, 0], [0, 0, 1], [0, -1, 0]])),
          "oblique": affine(rotation()),
          "left_handed": affine(rotation() @ numpy.diag([1, -1, 1]))}


def labels():
    """Two bodies that differ along every axis."""
    i, j, k = numpy.meshgrid(*(numpy.arange(n) for n in SIZE), indexing="ij")
    image = numpy.zeros(SIZE, int)
    image[(i > 1) & (i < 9) & (j > 2) & (j < 9) & (k > 1) & (k < 6)] = 3
    image[(i > 5) & (i < 9) & (j > 2) & (j < 6) & (k > 1) & (k < 4)] = 117
    return image


def info(path):
    """What the program shows of an image, but for its name: numbers as numbers."""
    shown = anatomesh("info", path).stdout
    rows = [line.split() for line in shown.splitlines()[1:]]
    return [[float(word) if word.lstrip("-").replace(".", "").isdigit() else word for word in row] for row in rows]


class Mgz(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, data, place):
        kind = nibabel.Nifti1Image if name.endswith(".nii") else nibabel.MGHImage
        nibabel.save(kind(data, place), self.folder / name)
        return str(self.folder / name)

    def expect_same(self, one, other):
        self.assertEqual(len(one), len(other))
        for row, other_row in zip(one, other):
            self.assertEqual(len(row), len(other_row))
            for value, other_value in zip(row, other_row):
                if isinstance(value, float):
                    self.assertAlmostEqual(value, other_value, places=4)
                else:
                    self.assertEqual(value, other_value)

    def test_place_and_labels(self):
        for name, place in PLACES.items():
            for kind in TYPES:
                data = labels().astype(kind)
                nifti = info(self.write("image.nii", data, place))
                for extension in ("mgh", "mgz"):
                    with self.subTest(place=name, kind=kind, extension=extension):
                        self.expect_same(info(self.write(f"image.{extension}", data, place)), nifti)

    def test_every_voxel_is_in_its_place(self):
        data = labels().astype("i2")
        for name, place in PLACES.items():
            with self.subTest(place=name):
                mesh = str(self.folder / "mesh.vtu")
                anatomesh("mesh", self.write("image.mgz", data, place), "-o", mesh, "--quiet")
                nifti = self.write("image.nii", data, place)
                checked = anatomesh("check", mesh, "--image", nifti, "--quiet", "--no-distances", check=False)
                self.assertEqual(checked.returncode, 0, checked.stdout)
                share = [line.split()[-2] for line in checked.stdout.splitlines() if line.startswith("voxels right")]
                self.assertGreater(float(share[0]), 94)


if __name__ == "__main__":
    run_tests()
