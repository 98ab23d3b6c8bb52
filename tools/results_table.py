#!/usr/bin/env python3
"""Measures Anatomesh on the three images that the method's authors publish, and writes the table in README.md.

usage: results_table.py FOLDER_OF_IMAGES [--program PATH] [--print]

FOLDER holds crtc_i2m_ventricles.nii.gz, crtc_i2m_nidus.nii.gz and crtc_i2m_brain.nii.gz. The authors' rows are their
own public code of 2014 with its tests' settings, run on a machine with 2 cores and measured the same way.
"""
import argparse
import pathlib
import sys
import tempfile

from measured_run import measure, stage_seconds
from pages import replace_between

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- results:begin -->", "<!-- results:end -->"

# Options of `anatomesh mesh`: with its defaults it makes fewer tetrahedra of these images than the authors' code.
OPTIONS = {"ventricles": [], "nidus": [], "brain": []}

AUTHORS = {
    "ventricles": {"tets": 102583, "seconds": 5.6 + 27.7, "dihedral": (0.54, 179.3), "dice": 0.903, "volume": -18.8,
                   "mean": 0.415, "p95": 1.018},
    "nidus": {"tets": 77415, "seconds": 3.9 + 24.5, "dihedral": (0.55, 178.9), "dice": 0.941, "volume": -10.7,
              "mean": 0.369, "p95": 0.859},
    "brain": {"tets": 31879, "seconds": 2.0 + 24.3, "dihedral": (1.37, 177.1), "dice": 0.967, "volume": -6.2,
              "mean": 1.305, "p95": 3.309},
}

HEADER = ("| image | program | tetrahedra | mesh s | dihedral | Dice | volume error | surface mean / 95 % mm |\n"
          "|---|---|---|---|---|---|---|---|\n")


def our_figures(program, folder, name):
    image = folder / f"crtc_i2m_{name}.nii.gz"
    with tempfile.TemporaryDirectory() as out:
        result = measure(program, image, OPTIONS[name], out)
        if result["mesh_status"] != 0 or "check" not in result:
            sys.exit(f"results_table: {image}: mesh ended with status {result['mesh_status']}\n"
                     + result["log"].read_text(encoding="utf-8"))
    whole, summary = (result["check"]["assessment"][part] for part in ("whole", "summary"))
    return {"tets": whole["quality"]["tets"],
            "seconds": stage_seconds(program, image, OPTIONS[name], ("read", "measure", "write")),
            "dihedral": (whole["quality"]["min_dihedral_deg"], whole["quality"]["max_dihedral_deg"]),
            "dice": whole["fidelity"]["dice"], "volume": whole["fidelity"]["volume_error_percent"],
            "mean": summary["surface_mean_mm"], "p95": summary["surface_p95_worst_mm"]}


def table_row(image, program, f):
    low, high = f["dihedral"]
    return (f"| {image} | {program} | {f['tets']:,} | {f['seconds']:.1f} | {low:.2f}° to {high:.2f}° | {f['dice']:.3f} "
            f"| {f['volume']:+.1f} % | {f['mean']:.3f} / {f['p95']:.3f} |\n")


def table(program, folder):
    rows = HEADER
    for name, authors in AUTHORS.items():
        rows += table_row(name, "authors, 2014", authors)
        options = "`" + " ".join(OPTIONS[name]) + "`" if OPTIONS[name] else "default options"
        rows += table_row(options, "**Anatomesh**", our_figures(program, folder, name))
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--program", default=ROOT / "build" / "release" / "bin" / "anatomesh", type=pathlib.Path)
    parser.add_argument("--print", action="store_true", help="print the table only")
    arguments = parser.parse_args()
    rows = table(arguments.program, arguments.folder)
    print(rows)
    if not arguments.print:
        replace_between(ROOT / "README.md", BEGIN, END, rows)
        print("results_table: README.md is rewritten")


if __name__ == "__main__":
    main()
