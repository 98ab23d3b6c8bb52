#!/usr/bin/env python3
"""Times `anatomesh mesh` from image file to mesh file, with the parameters of the method's paper unless told otherwise
(8 mm lattice, fidelity 0.95, face pattern, 10 iterations).

usage: file_to_file.py IMAGE [IMAGE ...] [--program PATH] [--runs N] [--options "..."]

Prints a row an image: tetrahedra, the median of the seconds of N runs with their range, tetrahedra a second, and the
largest peak memory. Nothing else should run on the machine; compare figures of one run only.
"""
import argparse
import json
import pathlib
import statistics
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
from measured_run import run  # noqa: E402

PAPER = "--bcc-size 8 --fidelity 0.95 --non-connectivity face --iterations 10"


def time_image(program, image, options, runs):
    with tempfile.TemporaryDirectory() as folder:
        mesh, report, log = (pathlib.Path(folder, name) for name in ("mesh.vtu", "report.json", "log"))
        command = [program, "mesh", image, "-o", mesh, *options]
        status, _, _ = run([*command, "--report", report], log)
        if status != 0:
            sys.exit(f"file_to_file: {image}: status {status}\n" + log.read_text(encoding="utf-8"))
        tets = json.loads(report.read_text(encoding="utf-8"))["assessment"]["whole"]["quality"]["tets"]
        measured = [run([*command, "--quiet"], log) for _ in range(runs)]
    seconds = sorted(s for _, s, _ in measured)
    return tets, seconds, max(mb for _, _, mb in measured)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("images", nargs="+", metavar="IMAGE")
    parser.add_argument("--program", default=ROOT / "build/release/bin/anatomesh")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--options", default=PAPER, help=f"[{PAPER}]")
    arguments = parser.parse_args()
    print("| image | tetrahedra | seconds, median (range) | tetrahedra a second | peak memory MB |\n|---|---|---|---|---|")
    for image in arguments.images:
        tets, seconds, memory = time_image(arguments.program, image, arguments.options.split(), arguments.runs)
        median = statistics.median(seconds)
        print(f"| {pathlib.Path(image).name.split('.')[0]} | {tets:,} | {median:.2f} ({seconds[0]:.2f} to {seconds[-1]:.2f})"
              f" | {tets / median:,.0f} | {memory:.0f} |", flush=True)


if __name__ == "__main__":
    main()
