#!/usr/bin/env python3
"""Times `anatomesh mesh` from image file to mesh file, with the parameters of the method's paper unless told otherwise
(8 mm lattice, fidelity 0.95 of the lattice, face pattern, 10 iterations), and with --cgal CGAL's Mesh_3 on the same image
at the same number of tetrahedra (+-10 %; one farther off is marked (!)), run by run in turn: sequential, with two threads,
and with two threads without its optimisers.

usage: file_to_file.py IMAGE [IMAGE ...] [--program PATH] [--runs N] [--options "..."] [--cgal] [--page docs/speed.md]

Prints a row a mesher: tetrahedra, the median of the seconds of N runs with their range, tetrahedra a second, peak memory,
and how many times as fast Anatomesh is; with --page also a plot, and the figures as JSON beside the page. Nothing else should run on the machine; compare figures of one run only.
"""
import argparse
import json
import pathlib
import statistics
import sys
import tempfile
import types

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "benchmarks")]
import compare_peers  # noqa: E402
import speed_plots  # noqa: E402
from measured_run import run  # noqa: E402
from pages import replace_between  # noqa: E402

PAPER = "--bcc-size 8 --fidelity 0.95 --fidelity-stage lattice --non-connectivity face --iterations 10"
CGAL = {
    "CGAL": [],
    "CGAL, 2 threads": ["--threads", "2"],
    "CGAL, 2 threads, no optimisers": ["--threads", "2", "--no-optimisers"],
}


def counted(command, report, log):
    """Tetrahedra of a first run, whose time does not count."""
    status, _, _ = run([*command, "--report", report], log)
    if status != 0:
        sys.exit(f"file_to_file: {command[2]}: status {status}\n" + log.read_text(encoding="utf-8"))
    return json.loads(report.read_text(encoding="utf-8"))["assessment"]


def cgal_size(arguments, image, assessment, folder):
    """The facet size at which CGAL's mesh has as many tetrahedra as ours."""
    wanted = assessment["whole"]["quality"]["tets"]
    volume_mm3 = sum(t["fidelity"]["image_volume_mm3"] for t in assessment["tissues"])
    limits = types.SimpleNamespace(cgal=arguments.cgal_program, timeout=600, memory=None)
    size, tried = 1.3 * (volume_mm3 / wanted) ** (1 / 3), {}
    for _ in range(8):
        result = compare_peers.run_cgal(limits, image, size, ["--threads", "2"], folder / "trial.vtu", folder / "cgal.log")
        if "failed" in result and not result["timed_out"]:
            sys.exit(f"file_to_file: CGAL: {result['failed']}")
        tried[size] = result.get("tets")
        if tried[size] and compare_peers.off(tried[size], wanted) <= 0.05:
            break
        size = compare_peers.next_size(tried, wanted)
    counts = {size: count for size, count in tried.items() if count}
    if not counts:
        sys.exit("file_to_file: CGAL: no mesh in time")
    return min(counts, key=lambda size: compare_peers.off(counts[size], wanted))


def time_image(arguments, image):
    """{mesher: (tetrahedra, sorted seconds, peak MB)}"""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mesh, report, log = folder / "mesh.vtu", folder / "report.json", folder / "log"
        ours = [arguments.program, "mesh", image, "-o", mesh, *arguments.options.split()]
        assessment = counted(ours, report, log)
        tets = {"Anatomesh": assessment["whole"]["quality"]["tets"]}
        commands = {"Anatomesh": [*ours, "--quiet"]}
        if arguments.cgal:
            size = cgal_size(arguments, image, assessment, folder)
            sizes = ["--facet-size", f"{size:.6g}", "--cell-size", f"{1.5 * size:.6g}", "--facet-distance", f"{size / 4:.6g}"]
            commands |= {peer: [arguments.cgal_program, image, "-o", folder / "cgal.vtu", *sizes, *options]
                         for peer, options in CGAL.items()}
        runs = {mesher: [] for mesher in commands}
        for _ in range(arguments.runs):
            for mesher, command in commands.items():
                log.unlink(missing_ok=True)
                status, seconds, memory_mb = run(command, log)
                if status != 0:
                    sys.exit(f"file_to_file: {mesher}: {log.read_text(encoding='utf-8')}")
                if mesher != "Anatomesh":
                    tets[mesher] = json.loads(log.read_text(encoding="utf-8").strip().splitlines()[-1])["tets"]
                runs[mesher].append((seconds, memory_mb))
    return {m: (tets[m], sorted(s for s, _ in r), max(mb for _, mb in r)) for m, r in runs.items()}


def rows(image, measured):
    far = {m: " (!)" if compare_peers.off(tets, measured["Anatomesh"][0]) > compare_peers.SAME_COUNT else ""
           for m, (tets, _, _) in measured.items()}
    rate = {m: tets / statistics.median(seconds) for m, (tets, seconds, _) in measured.items()}
    return [f"| {pathlib.Path(image).name.split('.')[0]} | {mesher} | {tets:,}{far[mesher]} | {statistics.median(seconds):.2f}"
            f" ({seconds[0]:.2f} to {seconds[-1]:.2f}) | {rate[mesher]:,.0f} | {memory:.0f} |"
            f" {rate['Anatomesh'] / rate[mesher]:.2f} |" for mesher, (tets, seconds, memory) in measured.items()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("images", nargs="+", metavar="IMAGE")
    parser.add_argument("--program", default=ROOT / "build/release/bin/anatomesh")
    parser.add_argument("--cgal-program", default=ROOT / "build/release/bin/cgal_mesh_3")
    parser.add_argument("--cgal", action="store_true", help="run CGAL in turn")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--options", default=PAPER, help=f"[{PAPER}]")
    parser.add_argument("--page", type=pathlib.Path, help="page to write the table into")
    arguments = parser.parse_args()
    lines = ["| image | mesher | tetrahedra | seconds, median (range) | tetrahedra a second | peak memory MB | Anatomesh is"
             " faster by |", "|---|---|---|---|---|---|---|"]
    print("\n".join(lines))
    figures = {}
    for image in arguments.images:
        measured = time_image(arguments, image)
        figures[pathlib.Path(image).name.split(".")[0]] = {
            mesher: {"tets": tets, "seconds": seconds, "memory_mb": memory}
            for mesher, (tets, seconds, memory) in measured.items()}
        lines += rows(image, measured)
        print("\n".join(lines[-len(CGAL) - 1 if arguments.cgal else -1:]), flush=True)
    if arguments.page:
        (arguments.page.parent / "speed_files.json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
        replace_between(arguments.page, "<!-- files:begin -->", "<!-- files:end -->", "\n".join(lines))
        speed_plots.draw_files(arguments.page.parent)


if __name__ == "__main__":
    main()
