#!/usr/bin/env python3
"""Counts the instructions of each stage on one small image (callgrind, one thread) and compares them with the figures
kept in benchmarks/instructions.json: unlike seconds they are the same on a busy machine.

usage: instructions.py [--program build/release/bin/bench_stages] [--write]

Ends with status 1 when a stage takes more than 1.3 times what it took; after a change that is meant to, --write keeps
the new figures. Ends with status 77 on a processor without AVX2, which takes other ones.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
KEPT = ROOT / "benchmarks" / "instructions.json"
MOST = 1.3
SKIPPED = 77  # exit status
STAGES = {  # and the function that is all of it
    "labels": "anatomesh::make_tissue_image(",
    "lattice": "anatomesh::LabelLattice::build(",
    "approach": "anatomesh::Deformer::approach(",
    "finish": "anatomesh::Deformer::finish(",
    "fidelity": "anatomesh::measure_fidelity(",
    "image_to_mesh": "anatomesh::image_to_mesh(",
}


def count(program):
    """Millions of instructions by stage."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder, "callgrind.out")
        done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", program,
                               "--benchmark_filter=^counted"], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit("instructions: valgrind failed\n" + done.stderr[-2000:])
        listing = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", out], check=True,
                                 capture_output=True, text=True).stdout
    counts = {}
    for line in listing.splitlines():
        match = re.match(r"\s*([\d,]+) \([\d. ]+%\)\s+\S*?:(anatomesh::.*)$", line)
        if not match:
            continue
        for stage, function in STAGES.items():
            if match.group(2).startswith(function):
                counts[stage] = max(counts.get(stage, 0), int(match.group(1).replace(",", "")) / 1e6)
    missing = STAGES.keys() - counts.keys()
    if missing:
        sys.exit(f"instructions: not in callgrind's listing: {', '.join(sorted(missing))}")
    return counts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build/release/bin/bench_stages")
    parser.add_argument("--write", action="store_true", help=f"keep the figures in {KEPT.relative_to(ROOT)}")
    arguments = parser.parse_args()
    cpu = pathlib.Path("/proc/cpuinfo")
    if not cpu.exists() or "avx2" not in cpu.read_text(encoding="utf-8"):
        print("instructions: skipped: the figures are those of a processor with AVX2")
        sys.exit(SKIPPED)
    counts = count(arguments.program)
    if arguments.write:
        KEPT.write_text(json.dumps({s: round(counts[s], 2) for s in STAGES}, indent=2) + "\n", encoding="utf-8")
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    slow = []
    for stage in STAGES:
        share = counts[stage] / kept[stage]
        print(f"{stage:14} {counts[stage]:10,.0f} million instructions, {share:.2f} of what is kept")
        if share > MOST:
            slow.append(stage)
    if slow:
        sys.exit(f"instructions: more than {MOST} times as many: {', '.join(slow)}")


if __name__ == "__main__":
    main()
