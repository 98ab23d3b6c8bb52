#!/usr/bin/env python3
"""Meshes and checks every image there is, and prints one row each.

usage: check_images.py [IMAGE ...] [--program PATH] [--out FOLDER] [--verdict] [--judge SCRIPT] [--options "..."]

Without IMAGE: those of $ANATOMESH_SHARED_DATA (or ../shared/data) and the label images of Debian's mricron-data.
--verdict compares the dihedral angles with VTK's mesh quality (python3-vtk9). --judge runs another evaluator,
SCRIPT IMAGE MESH --json FILE, and shows its Dice and angles beside ours. Exit status 1 when an image fails.
"""
import argparse
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

from measured_run import measure

ROOT = pathlib.Path(__file__).resolve().parent.parent
MRICRON = ["aal", "brodmann", "HarvardOxford-cort-maxprob-thr0-1mm", "JHU-WhiteMatter-labels-1mm",
           "JHU-WhiteMatter-labels-2mm", "natbrainlab", "jhu189", "inia19-NeuroMaps", "AICHAmc"]

# Images that ask for other options than the defaults.
IMAGE_OPTIONS = {}

VERDICT_TOLERANCE_DEG = 1e-3

COLUMNS = [  # title, width, how to show it
    ("image", 38, lambda r: r["name"]),
    ("exit", 4, lambda r: f"{r['mesh_status']}/{r.get('check_status', '-')}"),
    ("tets", 9, lambda r: f"{whole(r)['quality']['tets']:,}"),
    ("s", 7, lambda r: f"{r['seconds']:.1f}"),
    ("tets/s", 8, lambda r: f"{whole(r)['quality']['tets'] / r['seconds']:,.0f}"),
    ("MB", 6, lambda r: f"{r['memory_mb']:.0f}"),
    ("dihedral", 14, lambda r: "{:.2f}-{:.2f}".format(*angles(r))),
    ("ratio min/mean", 14, lambda r: f"{whole(r)['quality']['min_mean_ratio']:.3f}/{whole(r)['quality']['mean_mean_ratio']:.3f}"),
    ("labels", 9, lambda r: f"{summary(r)['labels_in_mesh']}/{summary(r)['labels_in_image']}"),
    ("Dice all/min/mean", 17, lambda r: f"{whole(r)['fidelity']['dice']:.3f}/{summary(r)['min_dice']:.3f}/{summary(r)['mean_dice']:.3f}"),
    ("volume %", 8, lambda r: f"{whole(r)['fidelity']['volume_error_percent']:+.1f}"),
    ("mean/95/max mm", 17, lambda r: "{surface_mean_mm:.3f}/{surface_p95_mean_mm:.2f}/{surface_max_mm:.1f}".format(**summary(r))),
    ("nm e/v", 11, lambda r: f"{summary(r)['nonmanifold_edges']}/{summary(r)['nonmanifold_vertices']}"),
    ("jump", 5, lambda r: f"{summary(r)['normal_jump_mean_deg']:.1f}"),
]


def whole(result):
    return result["check"]["assessment"]["whole"]


def summary(result):
    return result["check"]["assessment"]["summary"]


def angles(result):
    quality = whole(result)["quality"]
    return quality["min_dihedral_deg"], quality["max_dihedral_deg"]


def found_images():
    shared = pathlib.Path(os.environ.get("ANATOMESH_SHARED_DATA", ROOT.parent / "shared" / "data"))
    images = sorted(p for p in shared.glob("*") if p.name.endswith((".nii.gz", ".nrrd"))) if shared.is_dir() else []
    mricron = [pathlib.Path("/usr/share/mricron/templates", name + ".nii.gz") for name in MRICRON]
    return images + [p for p in mricron if p.exists()]


def vtk_angles(mesh):
    """Smallest and largest dihedral angle: the smallest by VTK's mesh quality (Verdict), the largest by numpy from
    the coordinates that VTK reads, since VTK offers no measure of it."""
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(mesh))
    quality = vtk.vtkMeshQuality()
    quality.SetInputConnection(reader.GetOutputPort())
    quality.SetTetQualityMeasureToMinAngle()
    quality.Update()
    smallest = vtk_to_numpy(quality.GetOutput().GetCellData().GetArray("Quality")).min()
    grid = reader.GetOutput()
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    corners = points[vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)]
    largest_cosine = -1.0
    for a, b, c, d in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 0, 2), (2, 3, 0, 1)):
        edge = corners[:, b] - corners[:, a]
        m = np.cross(edge, corners[:, c] - corners[:, a])
        n = np.cross(edge, corners[:, d] - corners[:, a])
        cosine = (m * n).sum(axis=1) / np.sqrt((m * m).sum(axis=1) * (n * n).sum(axis=1))
        largest_cosine = max(largest_cosine, -cosine.min())
    return float(smallest), float(np.degrees(np.arccos(np.clip(-largest_cosine, -1, 1))))


def verdict_fault(result):
    ours, theirs = angles(result), vtk_angles(result["mesh"])
    if all(abs(a - b) <= VERDICT_TOLERANCE_DEG for a, b in zip(ours, theirs)):
        return None
    return f"VTK measures {theirs[0]:.6f} to {theirs[1]:.6f} degrees, check {ours[0]:.6f} to {ours[1]:.6f}"


def judgement(script, image, mesh):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "judge.json")
        subprocess.run([script, image, mesh, "--json", out], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        judged = json.loads(out.read_text(encoding="utf-8"))
    return (f"judge: Dice {judged['union']['dice']:.3f}/{judged['summary']['dice_min']:.3f}/"
            f"{judged['summary']['dice_mean']:.3f}, dihedral {judged['overall']['min_dihedral']:.2f}-"
            f"{judged['overall']['max_dihedral']:.2f}")


def row(result):
    """A row of the table; a value that could not be measured is shown as a dash."""
    cells = []
    for _, width, show in COLUMNS:
        try:
            text = show(result)
        except (KeyError, TypeError, ValueError):
            text = "-"
        cells.append(text.ljust(width) if not cells else text.rjust(width))
    return "  ".join(cells)


def faults_of(result, arguments):
    if result["mesh_status"] != 0:
        return [f"mesh ended with status {result['mesh_status']}; see {result['log']}"]
    if "check" not in result:
        return [f"check ended with status {result['check_status']}; see {result['log']}"]
    faults = list(result["check"]["failed_guarantees"])
    if whole(result)["fidelity"]["dice"] < 0.9:
        faults.append(f"Dice of all labels is {whole(result)['fidelity']['dice']:.3f}, below 0.90")
    if arguments.verdict and (fault := verdict_fault(result)):
        faults.append(fault)
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("images", nargs="*", type=pathlib.Path, metavar="IMAGE")
    parser.add_argument("--program", default=ROOT / "build" / "release" / "bin" / "anatomesh", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, help="keep meshes, reports and logs in this folder")
    parser.add_argument("--verdict", action="store_true")
    parser.add_argument("--judge", type=pathlib.Path)
    parser.add_argument("--options", default="", help="further options of `anatomesh mesh`, in quotation marks")
    arguments = parser.parse_args()

    folder = arguments.out or pathlib.Path(tempfile.mkdtemp(prefix="anatomesh_images_"))
    folder.mkdir(parents=True, exist_ok=True)
    images = arguments.images or found_images()
    print("  ".join(title.ljust(width) if i == 0 else title.rjust(width) for i, (title, width, _) in enumerate(COLUMNS)))
    failed = 0
    for image in images:
        options = IMAGE_OPTIONS.get(image.name, []) + shlex.split(arguments.options)
        result = measure(arguments.program, image, options, folder)
        faults = faults_of(result, arguments)
        failed += bool(faults)
        print(row(result), flush=True)
        for fault in faults:
            print("    FAILED", fault)
        if arguments.judge and result["mesh_status"] == 0:
            print("   ", judgement(arguments.judge.resolve(), image, result["mesh"]), flush=True)
    print(f"{len(images) - failed} passed, {failed} failed; meshes and logs are in {folder}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
