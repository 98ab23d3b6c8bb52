"""Images that the tests share, and the program that the package is compared with."""
import importlib.util
import os
import pathlib
import subprocess
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("ANATOMESH_PROGRAM", str(ROOT / "build" / "ci" / "bin" / "anatomesh"))


def needs(*packages):
    """Skips a test where a package is not installed."""
    missing = [name for name in packages if importlib.util.find_spec(name) is None]
    return unittest.skipIf(missing, f"not installed: {', '.join(missing)}")


needs_program = unittest.skipUnless(os.path.exists(PROGRAM), f"{PROGRAM} is not built")


def nested_balls(size=(30, 28, 26), dtype=np.uint8):
    """A ball of label 1 off the middle, around one of label 7."""
    i, j, k = np.indices(size)
    distance = np.sqrt((i - 13) ** 2 + (j - 14) ** 2 + (k - 12) ** 2)
    return np.select([distance < 5, distance < 10], [7, 1], 0).astype(dtype)


def bars(n):
    """A cube of n voxels a side, cut into bars: work for some seconds."""
    i, j, _ = np.indices((n, n, n))
    return (1 + (i // 8 + 3 * (j // 8)) % 5).astype(np.uint8)


def oblique_left_handed():
    """From indices to RAS: turned about all axes, one axis mirrored, spacings 0.8, 1.0 and 1.3 mm."""
    turns = []
    for axis, angle in enumerate((0.3, -0.5, 0.9)):
        turn = np.eye(3)
        a, b = [n for n in range(3) if n != axis]
        turn[a, a] = turn[b, b] = np.cos(angle)
        turn[a, b], turn[b, a] = -np.sin(angle), np.sin(angle)
        turns.append(turn)
    affine = np.eye(4)
    affine[:3, :3] = turns[0] @ turns[1] @ turns[2] @ np.diag([0.8, 1.0, -1.3])
    affine[:3, 3] = [-40, 25, 300]
    return affine


def volumes(mesh):
    """Signed, of every tetrahedron."""
    a, b, c, d = (mesh.points[mesh.tets[:, n]] for n in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def centroid(mesh, label):
    """Of all tetrahedra of a label."""
    of_label = mesh.labels == label
    weights = volumes(mesh)[of_label]
    middles = mesh.points[mesh.tets[of_label]].mean(axis=1)
    return weights @ middles / weights.sum()


def run_program(*arguments):
    subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True)
