"""What the tests with programs and packages that are not ours share: meshes to test with, and measures of them.

The last argument of such a test is our program. Without numpy, importing this ends the test as skipped.
"""
import contextlib
import io
import json
import pathlib
import subprocess
import sys
import unittest

SKIPPED = 77    # the exit status that says so
AAL = pathlib.Path("/usr/share/mricron/templates/aal.nii.gz")

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))


def skip(why):
    """Ends the whole test, as skipped."""
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


@contextlib.contextmanager
def needed_packages():
    """What is imported within must be there, or the whole test is skipped."""
    try:
        yield
    except ImportError as error:
        skip(error)


with needed_packages():
    import numpy as np
    from make_vessel_tree import write_nifti


if len(sys.argv) < 2:
    sys.exit(sys.modules["__main__"].__doc__)


def run_tests(**settings):
    unittest.main(argv=sys.argv[:1], **settings)


def run(*command, check=True, folder=None):
    """What the command has said, once it has ended well."""
    return subprocess.run([str(word) for word in command], check=check, capture_output=True, text=True, cwd=folder,
                          stdin=subprocess.DEVNULL)


def anatomesh(*arguments, check=True):
    return run(sys.argv[-1], *arguments, check=check)


def convert(mesh, out, *options):
    anatomesh("convert", mesh, out, *options)
    return out


def quiet():
    """Nothing is printed within; meshio warns of what these tests mean to do."""
    stack = contextlib.ExitStack()
    stack.enter_context(contextlib.redirect_stdout(io.StringIO()))
    stack.enter_context(contextlib.redirect_stderr(io.StringIO()))
    return stack


# ---- images and their meshes

def balls():
    """A ball (3) with a core in it (7), beside another one that it touches (200)."""
    i, j, k = np.indices((26, 18, 18))
    voxels = np.zeros((26, 18, 18), np.uint8)
    voxels[(i - 8) ** 2 + (j - 9) ** 2 + (k - 9) ** 2 <= 42] = 3
    voxels[(i - 8) ** 2 + (j - 9) ** 2 + (k - 9) ** 2 <= 9] = 7
    voxels[(i - 19) ** 2 + (j - 9) ** 2 + (k - 9) ** 2 <= 25] = 200
    return voxels


def nested_balls():
    """A ball (2) in another (7), cut by the border of the image."""
    i, j, k = np.indices((24, 24, 20))
    distance = (i - 11.5) ** 2 + (j - 11.5) ** 2 + (k - 8) ** 2
    return np.where(distance <= 36, 2, np.where(distance <= 100, 7, 0)).astype(np.uint8)


def meshes(folder, voxels, *options, spacing_mm=1.0, extension=".vtk"):
    """By name, the mesh of "balls", made of the voxels with the options, and of "aal" where mricron-data is there."""
    write_nifti(folder / "balls.nii.gz", voxels, spacing_mm)
    made = {"balls": folder / f"balls{extension}"}
    anatomesh("mesh", folder / "balls.nii.gz", "-o", made["balls"], "--quiet", *options)
    if AAL.exists():
        made["aal"] = folder / f"aal{extension}"
        anatomesh("mesh", AAL, "-o", made["aal"], "--quiet", "--bcc-size", "32")
    return made


# ---- measures

def checked(mesh, *options):
    """What `anatomesh check` finds about a mesh."""
    report = mesh.with_name("check.json")
    anatomesh("check", mesh, *options, "--quiet", "--json", report, check=False)
    return json.loads(report.read_text(encoding="utf-8"))["assessment"]


def checked_volumes_mm3(mesh):
    """Volume of each tissue, as the program measures it."""
    tissues = checked(mesh, "--no-distances")["tissues"]
    return {tissue["label"]: tissue["quality"]["volume_mm3"] for tissue in tissues}


class Mesh:
    """Points, tetrahedra and labels, and what follows from them."""

    def __init__(self, points, tets, labels):
        self.points, self.tets = np.asarray(points, float), np.asarray(tets, int)
        self.labels = np.ravel(labels).astype(int)
        a, b, c, d = (self.points[self.tets[:, n]] for n in range(4))
        self.volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6

    def tissue_volumes(self):
        return {int(label): self.volumes[self.labels == label].sum() for label in np.unique(self.labels)}

    def outward_faces(self):
        """(corners, label inside, label outside or 0) of all faces where labels meet, as three arrays."""
        corners = np.concatenate([self.tets[:, side] for side in ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))])
        labels = np.tile(self.labels, 4)
        order = np.lexsort((labels, *np.sort(corners, axis=1).T))
        corners, labels = corners[order], labels[order]
        same = (np.sort(corners[1:], axis=1) == np.sort(corners[:-1], axis=1)).all(axis=1)
        first, second = np.append(same, False), np.insert(same, 0, False)
        outside = np.where(first, np.append(labels[1:], 0), 0)
        shown = ~second & (labels != outside)
        return corners[shown], labels[shown], outside[shown]

    def surfaces(self):
        """Faces, corners ascending, by the two labels that meet there; 0 is the outside."""
        found = {}
        for corners, inside, outside in zip(*(array.tolist() for array in self.outward_faces())):
            found.setdefault((inside, outside), set()).add(tuple(sorted(corners)))
        return found


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
