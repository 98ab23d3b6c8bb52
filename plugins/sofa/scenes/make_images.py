#!/usr/bin/env python3
"""Makes the label images of the scenes: a brain with ventricles and a tumour, and a vessel malformation in a block of
brain. The same bytes in every run; they lie beside the scenes already.

usage: make_images.py [FOLDER]
"""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "tools"))
from make_vessel_tree import write_nifti  # noqa: E402

BRAIN, VENTRICLE, TUMOUR = 1, 2, 3
TISSUE, VESSEL = 1, 2


def grid(size_mm, spacing):
    """Coordinates of the voxel centres from the middle of the image, mm."""
    axes = [(np.arange(round(s / spacing)) + 0.5) * spacing - s / 2 for s in size_mm]
    return np.meshgrid(*axes, indexing="ij")


def ellipsoid(x, y, z, centre, radii):
    return sum(((a - c) / r) ** 2 for a, c, r in zip((x, y, z), centre, radii)) <= 1


def brain(spacing=2.0):
    """Two hemispheres with a cleft between them, lateral ventricles as bent tubes, a ball of tumour."""
    x, y, z = grid((148, 180, 132), spacing)
    voxels = np.zeros(x.shape, np.uint8)
    outside = ellipsoid(x, y, z, (0, 0, 0), (67, 83, 59))
    cleft = (np.abs(x) < 3) & (z > 22)
    voxels[outside & ~cleft] = BRAIN
    for side in (-1, 1):
        bend = z - 8 + ((y - 4) / 22) ** 2 * 4
        horn = ((np.abs(x) * np.sign(x) * side - 13 - np.abs(y) / 8) / 6) ** 2 + (bend / 7) ** 2 + (y / 40) ** 2 <= 1
        voxels[horn] = VENTRICLE
    voxels[ellipsoid(x, y, z, (36, -22, 20), (11, 11, 11))] = TUMOUR
    return voxels


def malformation(spacing=1.0):
    """A tangle of three tubes that wind around one another, with a feeding vessel."""
    x, y, z = grid((64, 64, 56), spacing)
    voxels = np.zeros(x.shape, np.uint8)
    voxels[ellipsoid(x, y, z, (0, 0, 0), (29, 29, 25))] = TISSUE
    for strand in range(3):
        for t in np.linspace(0, 1, 160):
            angle = 2 * np.pi * (1.6 * t + strand / 3)
            radius = 9 * np.sin(np.pi * t) + 1.5
            place = (radius * np.cos(angle), radius * np.sin(angle), -12 + 24 * t)
            voxels[ellipsoid(x, y, z, place, (2.6,) * 3) & (voxels > 0)] = VESSEL
    feeder = (x ** 2 + y ** 2 <= 9) & (z < -10)
    voxels[feeder & (voxels > 0)] = VESSEL
    return voxels


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent
    write_nifti(folder / "brain.nii.gz", brain(), 2.0)
    write_nifti(folder / "malformation.nii.gz", malformation(), 1.0)


if __name__ == "__main__":
    main()
