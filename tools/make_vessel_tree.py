#!/usr/bin/env python3
"""Makes a label image of a vessel tree in a block of tissue: no file of real vessels is needed for the pictures.

usage: make_vessel_tree.py IMAGE.nii.gz [--spacing MM]

Label 1 is the block, label 2 the vessels: tubes of 4 mm radius at the root, which leaves through the border of the image,
down to 0.7 mm. A few specks of label 2 lie apart, as a threshold leaves them. The same bytes in every run.
"""
import argparse
import gzip
import math
import pathlib
import struct
import typing

import numpy as np

TISSUE, VESSEL = 1, 2
SIZE_MM = np.array([64.0, 64.0, 72.0])  # of the image
MARGIN_MM = 3.0                         # background around the block, but below: there it ends at the image's border
ROOT_RADIUS_MM, SMALLEST_RADIUS_MM = 4.0, 0.7
CHILDREN = ((0.78, 28.0), (0.60, 48.0))  # radius and angle in degrees of the two branches, relative to their parent
GOLDEN_ANGLE = math.radians(137.508)     # by which the plane of a branching turns from the one before
WALL_MM = 8.0                            # within it of the block's sides branches turn back inward

# Centre, as shares of the image's size, and radius in mm of the specks.
SPECKS = ((0.25, 0.25, 0.30, 0.8), (0.75, 0.20, 0.22, 1.1), (0.20, 0.72, 0.20, 0.6), (0.85, 0.50, 0.45, 0.9))


class Tube(typing.NamedTuple):
    """A straight tube whose radius goes from one end's to the other's."""
    begin: np.ndarray
    end: np.ndarray
    begin_radius: float
    end_radius: float


def turned(direction, angle, turn):
    """`direction` bent by `angle` in the plane that `turn` (both in radians) chooses."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    u = np.cross(direction, helper)
    u /= np.linalg.norm(u)
    v = np.cross(direction, u)
    return math.cos(angle) * direction + math.sin(angle) * (math.cos(turn) * u + math.sin(turn) * v)


def kept_inside(begin, direction, length):
    """The direction, turned towards the middle of the block where the tube would come near its sides."""
    end = begin + length * direction
    low, high = np.full(3, MARGIN_MM + WALL_MM), SIZE_MM - MARGIN_MM - WALL_MM
    direction = np.clip(end, low, high) - begin
    return direction / np.linalg.norm(direction)


def tubes_from(begin, direction, radius, turn):
    """The tube that starts there, and all its branches."""
    length = 5.0 + 4.0 * radius
    direction = kept_inside(begin, direction, length)
    end = begin + length * direction
    end_radius = max(0.92 * radius, SMALLEST_RADIUS_MM)
    tubes = [Tube(begin, end, radius, end_radius)]
    for number, (share, degrees) in enumerate(CHILDREN):
        if share * radius < SMALLEST_RADIUS_MM:
            continue
        bent = turned(direction, math.radians(degrees), turn + number * math.pi)
        tubes += tubes_from(end, bent, share * radius, turn + GOLDEN_ANGLE)
    return tubes


def tree():
    root = np.array([SIZE_MM[0] / 2, SIZE_MM[1] / 2, -2 * ROOT_RADIUS_MM])
    return tubes_from(root, np.array([0.0, 0.0, 1.0]), ROOT_RADIUS_MM, math.pi / 2)


def draw_tube(voxels, spacing, tube):
    low = np.minimum(tube.begin, tube.end) - tube.begin_radius
    high = np.maximum(tube.begin, tube.end) + tube.begin_radius
    first = np.maximum(np.floor(low / spacing).astype(int), 0)
    last = np.minimum(np.ceil(high / spacing).astype(int) + 1, voxels.shape)
    if np.any(first >= last):
        return
    centres = np.stack(np.meshgrid(*(np.arange(a, b) for a, b in zip(first, last)), indexing="ij"), axis=-1) * spacing
    axis = tube.end - tube.begin
    share = np.clip((centres - tube.begin) @ axis / max(axis @ axis, 1e-12), 0, 1)
    distance = np.linalg.norm(centres - tube.begin - share[..., None] * axis, axis=-1)
    inside = distance <= tube.begin_radius + share * (tube.end_radius - tube.begin_radius)
    voxels[tuple(slice(a, b) for a, b in zip(first, last))][inside] = VESSEL


def vessel_tree(spacing):
    """The labels, voxels[i, j, k]."""
    voxels = np.zeros(np.round(SIZE_MM / spacing).astype(int), np.uint8)
    margin = round(MARGIN_MM / spacing)
    voxels[margin:-margin, margin:-margin, :-margin] = TISSUE
    for tube in tree():
        draw_tube(voxels, spacing, tube)
    for *place, radius in SPECKS:
        centre = np.array(place) * SIZE_MM
        draw_tube(voxels, spacing, Tube(centre, centre, radius, radius))
    return voxels


def write_nifti(path, voxels, spacing):
    """NIfTI-1 of 8-bit labels whose axes are LPS and whose origin is 0."""
    header = bytearray(352)  # with the empty extension flags
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *voxels.shape, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 2, 8)                               # unsigned 8-bit
    struct.pack_into("<8f", header, 76, 1, spacing, spacing, spacing, 0, 0, 0, 0)
    struct.pack_into("<fff", header, 108, 352, 1, 0)                        # where the voxels start; slope and intercept
    header[123] = 2                                                         # mm
    struct.pack_into("<hh", header, 252, 0, 1)                              # no qform; sform of scanner coordinates
    struct.pack_into("<12f", header, 280, -spacing, 0, 0, 0, 0, -spacing, 0, 0, 0, 0, spacing, 0)
    header[344:348] = b"n+1\0"
    pathlib.Path(path).write_bytes(gzip.compress(bytes(header) + voxels.tobytes(order="F"), 6, mtime=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("image", type=pathlib.Path)
    parser.add_argument("--spacing", type=float, default=0.6, help="of the voxels, mm [0.6]")
    arguments = parser.parse_args()
    voxels = vessel_tree(arguments.spacing)
    write_nifti(arguments.image, voxels, arguments.spacing)
    print(f"{arguments.image}: {' x '.join(map(str, voxels.shape))} voxels, {np.count_nonzero(voxels == VESSEL):,} of vessels, "
          f"{len(tree())} tubes")


if __name__ == "__main__":
    main()
