#!/usr/bin/env python3
"""Runs the benchmarks of bench_stages, each case in a process of its own for the sake of its peak memory, and writes the
table and the plots of docs/speed.md.

usage: suite.py [--program build/release/bin/bench_stages] [--filter REGEX] [--runs N] [--page docs/speed.md]

Nothing else should run on the machine. Figures are the medians of N runs; kept in docs/speed.json, so that --filter
measures some anew and leaves the others.
"""
import argparse
import datetime
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "benchmarks")]
from measured_run import run  # noqa: E402
from pages import replace_between  # noqa: E402
import speed_plots  # noqa: E402

KEPT = ROOT / "docs" / "speed.json"
CASE = re.compile(r"(?P<stage>\w+)/side:(?P<side>\d+)/labels:(?P<labels>\d+)/bcc:(?P<bcc>\d+)/threads:(?P<threads>\d+)")


def measure(program, name, runs):
    """{"ms": .., "tets": .., "memory_mb": ..} of one benchmark."""
    seconds, memory = [], 0
    with tempfile.TemporaryDirectory() as folder:
        out, log = pathlib.Path(folder, "out.json"), pathlib.Path(folder, "log")
        for _ in range(runs):
            status, _, mb = run([program, f"--benchmark_filter=^{name}$", f"--benchmark_out={out}",
                                 "--benchmark_out_format=json"], log)
            if status != 0:
                sys.exit(f"suite: {name}: status {status}\n" + log.read_text(encoding="utf-8"))
            result = json.loads(out.read_text(encoding="utf-8"))["benchmarks"][0]
            seconds.append(result["real_time"])
            memory = max(memory, mb)
    return {"ms": statistics.median(seconds), "tets": result.get("tets"), "memory_mb": memory,
            "date": datetime.date.today().isoformat()}


def row(name, figures):
    case = CASE.match(name)
    tets = figures["tets"]
    rate = f"{1000 * tets / figures['ms']:,.0f}" if tets else "–"
    voxels = int(case["side"]) ** 3 / 1e6
    return (f"| {case['stage']} | {voxels:.1f} | {case['labels']} | {int(case['bcc']) / 100:g} | {case['threads']} |"
            f" {f'{tets:,.0f}' if tets else '–'} | {figures['ms']:,.0f} | {rate} | {figures['memory_mb']:,.0f} |")


def table(kept):
    lines = ["| stage | million voxels | labels | lattice, voxels | threads | tetrahedra | ms | tetrahedra a second | peak MB |",
             "|---|---|---|---|---|---|---|---|---|"]
    return "\n".join(lines + [row(name, figures) for name, figures in kept.items()]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build/release/bin/bench_stages")
    parser.add_argument("--filter", default=".", help="regular expression: these benchmarks only")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "docs" / "speed.md")
    arguments = parser.parse_args()
    names = subprocess.run([arguments.program, "--benchmark_list_tests"], check=True, capture_output=True,
                           text=True).stdout.split()
    names = [name for name in names if not name.startswith("counted")]
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    for name in names:
        if re.search(arguments.filter, name):
            kept[name] = measure(arguments.program, name, arguments.runs)
            print(row(name, kept[name]), flush=True)
            in_order = {name: kept[name] for name in names if name in kept}
            KEPT.write_text(json.dumps(in_order, indent=1) + "\n", encoding="utf-8")
    kept = {name: kept[name] for name in names if name in kept}
    replace_between(arguments.page, "<!-- stages:begin -->", "<!-- stages:end -->", table(kept))
    speed_plots.draw_stages(arguments.page.parent, {name: CASE.match(name).groupdict() | kept[name] for name in kept})


if __name__ == "__main__":
    main()
