#!/usr/bin/env python3
"""Slices of a label image with the outlines of its mesh drawn over them: shows where the surfaces lie.

usage: render_slices.py IMAGE MESH PICTURE.png [--at I J K] [--box I J K HALF] [--frame lps|ras]

One picture for each index axis, through voxel I J K (the middle of the labelled voxels when not given). --box shows
only the voxels within HALF of I J K, so that single ones can be seen. Images: NIfTI, NRRD, MetaImage (.mha).
Needs python3-matplotlib, python3-nibabel and python3-vtk9.
"""
import argparse
import gzip
import pathlib
import sys
import zlib

import matplotlib
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
from matplotlib.collections import LineCollection  # noqa: E402

from render_mesh import read_mesh, tissue_colours  # noqa: E402

NRRD_TYPES = {"uchar": "u1", "uint8": "u1", "unsigned char": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
              "unsigned short": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "unsigned int": "u4",
              "uint32": "u4", "float": "f4", "double": "f8"}
META_TYPES = {"MET_UCHAR": "u1", "MET_CHAR": "i1", "MET_SHORT": "i2", "MET_USHORT": "u2", "MET_INT": "i4",
              "MET_UINT": "u4", "MET_FLOAT": "f4", "MET_DOUBLE": "f8"}


def read_nifti(path):
    import nibabel
    image = nibabel.load(path)
    affine = np.diag([-1.0, -1, 1, 1]) @ image.affine  # RAS to LPS
    return np.asarray(image.dataobj).squeeze(), affine


def read_nrrd(path):
    head, _, data = path.read_bytes().partition(b"\n\n")
    fields = dict(line.split(":", 1) for line in head.decode("latin1").splitlines()
                  if ":" in line and not line.startswith("#"))
    fields = {key.strip().lower(): value.lstrip("=").strip() for key, value in fields.items()}
    if fields["encoding"] in ("gzip", "gz"):
        data = gzip.decompress(data)
    order = ">" if fields.get("endian") == "big" else "<"
    size = [int(n) for n in fields["sizes"].split()]
    voxels = np.frombuffer(data, order + NRRD_TYPES[fields["type"]]).reshape(size, order="F")
    vectors = [[float(x) for x in v.split(",")] for v in fields["space directions"].strip("()").split(") (")]
    affine = np.eye(4)
    affine[:3, :3] = np.array(vectors).T
    affine[:3, 3] = [float(x) for x in fields["space origin"].strip("()").split(",")]
    flips = {"right-anterior-superior": (-1, -1, 1), "ras": (-1, -1, 1), "left-anterior-superior": (1, -1, 1),
             "las": (1, -1, 1)}.get(fields["space"].lower(), (1, 1, 1))
    return voxels, np.diag(flips + (1,)) @ affine


def read_meta_image(path):
    data = path.read_bytes()
    end = data.index(b"\n", data.index(b"ElementDataFile")) + 1
    fields = dict(line.split(" = ", 1) for line in data[:end].decode("latin1").split("\n") if " = " in line)
    numbers = {key: np.array(fields[key].split(), float) for key in ("DimSize", "ElementSpacing", "Offset")}
    raw = zlib.decompress(data[end:]) if fields.get("CompressedData") == "True" else data[end:]
    voxels = np.frombuffer(raw, META_TYPES[fields["ElementType"]]).reshape(numbers["DimSize"].astype(int), order="F")
    affine = np.eye(4)
    axes = np.array(fields.get("TransformMatrix", "1 0 0 0 1 0 0 0 1").split(), float).reshape(3, 3)
    affine[:3, :3] = axes.T * numbers["ElementSpacing"]
    affine[:3, 3] = numbers["Offset"]
    return voxels, affine


def read_image(path):
    """Voxels[i, j, k] and the matrix from index to LPS mm."""
    readers = [(".nii", read_nifti), (".nii.gz", read_nifti), (".nrrd", read_nrrd), (".mha", read_meta_image)]
    for ending, reader in readers:
        if path.name.endswith(ending):
            return reader(path)
    sys.exit(f"render_slices: {path}: unknown extension; use .nii, .nii.gz, .nrrd or .mha")


def interface_triangles(mesh):
    """The faces where the label changes: (n, 3) vertex numbers."""
    tets = vtk_to_numpy(mesh.GetCells().GetConnectivityArray()).reshape(-1, 4)
    labels = vtk_to_numpy(mesh.GetCellData().GetArray("label")).astype(np.int64)
    faces = np.sort(np.concatenate([tets[:, corners] for corners in ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))]))
    owner = np.tile(labels, 4)
    order = np.lexsort(faces.T)
    faces, owner = faces[order], owner[order]
    same = np.all(faces[1:] == faces[:-1], axis=1)
    inner = np.flatnonzero(same)
    outer = np.flatnonzero(~np.concatenate([[False], same]) & ~np.concatenate([same, [False]]))
    return np.concatenate([faces[inner[owner[inner] != owner[inner + 1]]], faces[outer]])


def cut(points, triangles, axis, position):
    """Segments (n, 2, 3) where the triangles meet the plane index[axis] == position."""
    height = points[triangles][:, :, axis] - position
    height[height == 0] = 1e-9
    ends = []
    for a, b in ((0, 1), (1, 2), (2, 0)):
        share = height[:, a] / (height[:, a] - height[:, b] + 1e-300)
        crossing = points[triangles[:, a]] + share[:, None] * (points[triangles[:, b]] - points[triangles[:, a]])
        crossing[(height[:, a] > 0) == (height[:, b] > 0)] = np.nan
        ends.append(crossing)
    ends = np.stack(ends, axis=1)
    hit = np.isnan(ends[:, :, 0]).sum(axis=1) == 1
    return ends[hit][~np.isnan(ends[hit][:, :, 0])].reshape(-1, 2, 3)


def draw(axes, voxels, spacing, segments, axis, centre, half):
    """One slice at centre[axis], the tissues pale, the segments in black; `half`: voxels shown around the centre."""
    rows, columns = [a for a in range(3) if a != axis][::-1]
    values = np.unique(voxels)
    palette = np.vstack([[1, 1, 1], 0.35 + 0.65 * tissue_colours(len(values) - (values[0] == 0))])
    shown = np.searchsorted(values, np.take(voxels, int(round(centre[axis])), axis=axis)).T + (values[0] != 0)
    axes.imshow(palette[shown], origin="lower", interpolation="nearest", aspect=spacing[rows] / spacing[columns])
    axes.add_collection(LineCollection(segments[:, :, [columns, rows]], colors="black", linewidths=0.7))
    if half:
        axes.set_xlim(centre[columns] - half, centre[columns] + half)
        axes.set_ylim(centre[rows] - half, centre[rows] + half)


def index_points(mesh, affine, frame="lps"):
    """The mesh's vertices in voxels of the image."""
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    if frame == "ras":
        points = points * [-1, -1, 1]
    return (points - affine[:3, 3]) @ np.linalg.inv(affine[:3, :3]).T


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("image", type=pathlib.Path)
    parser.add_argument("mesh")
    parser.add_argument("picture")
    parser.add_argument("--at", type=float, nargs=3, metavar=("I", "J", "K"))
    parser.add_argument("--box", type=float, nargs=4, metavar=("I", "J", "K", "HALF"))
    parser.add_argument("--frame", choices=["lps", "ras"], default="lps")
    arguments = parser.parse_args()

    voxels, affine = read_image(arguments.image)
    voxels = voxels.astype(np.int64)
    mesh = read_mesh(arguments.mesh)
    index = index_points(mesh, affine, arguments.frame)
    labelled = np.argwhere(voxels)
    middle = (labelled.min(axis=0) + labelled.max(axis=0)) / 2
    centre = np.array(arguments.box[:3] if arguments.box else arguments.at or middle)
    spacing = np.linalg.norm(affine[:3, :3], axis=0)
    triangles = interface_triangles(mesh)

    figure, panels = plt.subplots(1, 3, figsize=(24, 8.5), dpi=100)
    for axis, panel in enumerate(panels):
        segments = cut(index, triangles, axis, round(centre[axis]))
        draw(panel, voxels, spacing, segments, axis, centre, arguments.box[3] if arguments.box else None)
        rows, columns = [a for a in range(3) if a != axis][::-1]
        panel.set(title=f"{'ijk'[axis]} = {int(round(centre[axis]))}", xlabel="ijk"[columns], ylabel="ijk"[rows])
    figure.suptitle(f"{arguments.image.name} and {pathlib.Path(arguments.mesh).name}")
    figure.tight_layout()
    figure.savefig(arguments.picture)


if __name__ == "__main__":
    main()
