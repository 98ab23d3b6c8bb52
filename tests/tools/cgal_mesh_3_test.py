#!/usr/bin/env python3
"""The driver of CGAL's Mesh_3 keeps labels and place, also in a turned and mirrored frame.

usage: cgal_mesh_3_test.py CGAL_MESH_3 ANATOMESH      exit status 77 (skipped) without numpy
"""
import gzip
import json
import pathlib
import struct
import sys
import tempfile
import unittest

from demo_meshes import checked, run, run_tests, write_nifti

import numpy as np    # it is there: demo_meshes needs it

TURNED = ((0, -1.8, 0, 12), (2.4, 0, 0, -30), (0, 0, 1.2, 5))    # rows of the sform: a turn about z
MIRRORED = ((1.8, 0, 0, 7), (0, 2.4, 0, 3), (0, 0, 1.2, -40))    # the same in LPS has a negative determinant


def balls(first, second):
    """Two touching balls, one of which runs out of the image."""
    i, j, k = np.indices((24, 20, 30))
    voxels = np.zeros((24, 20, 30), np.uint8)
    voxels[(i - 8) ** 2 + (j - 10) ** 2 + (k - 12) ** 2 <= 49] = first
    voxels[(i - 20) ** 2 + (j - 10) ** 2 + (k - 12) ** 2 <= 36] = second
    return voxels


def write_image(path, voxels, sform):
    write_nifti(path, voxels, 1.0)
    header = bytearray(gzip.decompress(path.read_bytes()))
    struct.pack_into("<12f", header, 280, *(x for row in sform for x in row))
    spacing = np.linalg.norm(np.array(sform)[:, :3], axis=0)
    struct.pack_into("<3f", header, 80, *spacing)
    path.write_bytes(gzip.compress(bytes(header)))


class Driver(unittest.TestCase):
    def check(self, sform, *options):
        with tempfile.TemporaryDirectory() as folder:
            image, mesh = (pathlib.Path(folder, name) for name in ("image.nii.gz", "mesh.vtu"))
            write_image(image, balls(7, 250), sform)
            done = run(CGAL, image, "-o", mesh, "--facet-size", "3", "--cell-size", "4", "--facet-distance", "0.4",
                       *options)
            return json.loads(done.stdout), checked(mesh, "--image", image)

    def test_keeps_labels_and_place(self):
        for sform in (TURNED, MIRRORED):
            for options in ((), ("--weights",)):
                with self.subTest(sform=sform, options=options):
                    printed, measured = self.check(sform, *options)
                    self.assertEqual(printed["tets"], measured["whole"]["quality"]["tets"])
                    self.assertEqual([t["label"] for t in measured["tissues"]], [7, 250])
                    self.assertFalse(measured["conformity"]["negative_orientation"])
                    self.assertEqual(measured["whole"]["quality"]["inverted"], 0)
                    self.assertGreater(measured["summary"]["min_dice"], 0.95)

    def test_says_what_is_wrong(self):
        done = run(CGAL, "missing.nii.gz", "-o", "/tmp/mesh.vtu", check=False)
        self.assertEqual(done.returncode, 4)
        self.assertIn("missing.nii.gz", done.stderr)


if __name__ == "__main__":
    CGAL = sys.argv[1]
    run_tests()
