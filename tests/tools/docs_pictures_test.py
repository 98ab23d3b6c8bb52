#!/usr/bin/env python3
"""tools/make_vessel_tree.py and the table of tools/make_docs_pictures.py. Skipped (status 77) without their packages."""
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
try:
    import numpy as np
    from make_vessel_tree import ROOT_RADIUS_MM, SMALLEST_RADIUS_MM, TISSUE, VESSEL, tree, vessel_tree, write_nifti
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


def parts(mask):
    """Number of 26-connected parts, by spreading the largest number of each neighbourhood."""
    numbers = np.where(mask, np.arange(1, mask.size + 1).reshape(mask.shape), 0)
    while True:
        spread = numbers
        for axis in range(3):
            grown = np.zeros_like(spread)
            ahead, behind = [slice(None)] * 3, [slice(None)] * 3
            ahead[axis], behind[axis] = slice(1, None), slice(None, -1)
            grown[tuple(behind)] = spread[tuple(ahead)]
            grown[tuple(ahead)] = np.maximum(grown[tuple(ahead)], spread[tuple(behind)])
            spread = np.maximum(spread, grown)
        spread = np.where(mask, spread, 0)
        if np.array_equal(spread, numbers):
            return len(np.unique(numbers)) - 1
        numbers = spread


class VesselTree(unittest.TestCase):
    voxels = vessel_tree(0.6)

    def test_has_the_radii_it_promises(self):
        radii = [r for tube in tree() for r in (tube.begin_radius, tube.end_radius)]
        self.assertEqual(max(radii), ROOT_RADIUS_MM)
        self.assertGreaterEqual(min(radii), SMALLEST_RADIUS_MM)
        self.assertLess(min(radii), 1.1 * SMALLEST_RADIUS_MM)

    def test_is_one_tree_and_four_specks(self):
        self.assertEqual(parts(self.voxels == VESSEL), 5)

    def test_lies_inside_the_block_but_for_its_root(self):
        self.assertEqual(set(np.unique(self.voxels)), {0, TISSUE, VESSEL})
        vessel = np.argwhere(self.voxels == VESSEL)
        block = np.argwhere(self.voxels != 0)
        self.assertTrue((vessel.min(axis=0)[:2] > block.min(axis=0)[:2]).all())
        self.assertTrue((vessel.max(axis=0) < block.max(axis=0)).all())
        self.assertEqual(vessel.min(axis=0)[2], 0)

    def test_file_is_the_same_in_every_run(self):
        with tempfile.TemporaryDirectory() as folder:
            paths = [pathlib.Path(folder, name) for name in ("a.nii.gz", "b.nii.gz")]
            for path in paths:
                write_nifti(path, vessel_tree(1.2), 1.2)
            self.assertEqual(paths[0].read_bytes(), paths[1].read_bytes())


class Pictures(unittest.TestCase):
    def test_every_picture_has_its_place_in_the_page(self):
        try:
            from make_docs_pictures import PAGE, PICTURES, VIEWS
        except ImportError as error:
            self.skipTest(str(error))
        names = [picture.name for picture in PICTURES]
        self.assertEqual(len(names), len(set(names)))
        in_page = re.findall(r"<!-- (\S+):begin -->", PAGE.read_text(encoding="utf-8"))
        self.assertEqual(sorted(names), sorted(in_page))
        for picture in PICTURES:
            self.assertIn(picture.view, VIEWS[picture.image])


if __name__ == "__main__":
    unittest.main()
