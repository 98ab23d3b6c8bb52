"""Meshes for the tests of files, made by the program, and what can be measured on triangles."""
import json
import pathlib
import subprocess
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from make_vessel_tree import write_nifti  # noqa: E402  (the path is set above)

AAL = pathlib.Path("/usr/share/mricron/templates/aal.nii.gz")


def run(program, *arguments):
    subprocess.run([program, *map(str, arguments)], check=True, capture_output=True)


def two_balls(path):
    """A ball in another, of labels 2 and 7, cut by the border of the image."""
    i, j, k = np.indices((24, 24, 20))
    distance = (i - 11.5) ** 2 + (j - 11.5) ** 2 + (k - 8) ** 2
    voxels = np.where(distance <= 36, 2, np.where(distance <= 100, 7, 0)).astype(np.uint8)
    write_nifti(path, voxels, 1.0)


def meshes(program, folder):
    """Meshes to test with: a small one, and AAL where mricron-data is installed."""
    image = folder / "balls.nii.gz"
    two_balls(image)
    run(program, "mesh", image, "-o", folder / "balls.vtk", "--quiet")
    yield folder / "balls.vtk"
    if AAL.exists():
        run(program, "mesh", AAL, "-o", folder / "aal.vtk", "--bcc-size", "32", "--quiet")
        yield folder / "aal.vtk"


def volumes_mm3(program, mesh):
    """Volume of each tissue, as the program measures it."""
    report = mesh.with_suffix(".json")
    subprocess.run([program, "check", mesh, "--json", report, "--quiet"], check=False, capture_output=True)
    tissues = json.loads(report.read_text(encoding="utf-8"))["assessment"]["tissues"]
    return {tissue["label"]: tissue["quality"]["volume_mm3"] for tissue in tissues}


def volume_inside(corners):
    """By the divergence theorem; corners: (triangles, 3, 3)."""
    a, b, c = np.moveaxis(corners - corners.mean(axis=(0, 1)), 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def is_closed(triangles):
    """Whether each edge is passed as often one way as the other; triangles: ids (triangles, 3)."""
    edges = np.concatenate([triangles[:, (0, 1)], triangles[:, (1, 2)], triangles[:, (2, 0)]]).astype(np.int64)
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, number = np.unique(low * (edges.max() + 1) + high, return_inverse=True)
    return not np.bincount(number, weights=np.where(edges[:, 0] < edges[:, 1], 1, -1)).any()
