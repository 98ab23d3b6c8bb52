#!/usr/bin/env python3
"""Runs the brain scene of the SOFA plugin on our mesh, on our mesh without its guard of angles and on CGAL's mesh of the
same image at the same number of tetrahedra, and writes the tables of docs/sofa.md.

usage: sofa_steps.py [--build FOLDER] [--out FOLDER] [--tets N] [--table | --picture]

The conjugate gradient has no limit of iterations that it would reach, so that their number shows how well conditioned the
mesh is. --table only rewrites the page from the figures of an earlier run; --picture only draws the malformation that the
tool has pulled (python3-vtk9, and a display or xvfb-run). Build with -DANATOMESH_BUILD_PEERS=ON, where SOFA is found, first.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "benchmarks"))
sys.path.insert(0, str(ROOT / "tools"))
from compare_peers import next_size, off  # noqa: E402
from mesh_figures import figures  # noqa: E402
from pages import replace_between  # noqa: E402

SCENES = ROOT / "plugins/sofa/scenes"
IMAGE = SCENES / "brain.nii.gz"
PAGE = ROOT / "docs/sofa.md"
BEGIN, END = "<!-- steps:begin -->", "<!-- steps:end -->"

UNGUARDED = ["--min-dihedral", "0", "--max-dihedral", "180", "--min-mean-ratio", "0"]
BCC_SIZES_MM = [10 + 0.5 * n for n in range(21)]
TIME_STEPS_S = (0.02, 0.04, 0.08, 0.16)
PICTURE = ROOT / "docs/images/sofa_pulled.png"
PULLED = ["--elements-across", "1", "--young", "3000", "--young", "2=30000", "--poisson", "0.45"]  # as malformation.scn

SAME_COUNT = 0.05
MOST_RUNS = 10
MATERIALS = 'tissue="1=brain 3=tumour" young="2=500" poisson="2=0.45"'
ONE_MATERIAL = 'young="3000" poisson="0.45"'  # for meshes that lack a tissue
AT_REST_MM_S = 0.5


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    return done.stdout


def mesh_ours(program, mesh, *options):
    run(program, "mesh", IMAGE, "-o", mesh, "--quiet", *options)


def mesh_unguarded(program, wanted, mesh):
    """The mesh without guard of the lattice whose number of tetrahedra comes nearest."""
    counts = {}
    for size in BCC_SIZES_MM:
        mesh_ours(program, mesh, "--bcc-size", size, *UNGUARDED)
        counts[size] = judge(program, mesh)["tets"]
    mesh_ours(program, mesh, "--bcc-size", min(counts, key=lambda size: off(counts[size], wanted)), *UNGUARDED)


def mesh_with_cgal(cgal, wanted, mesh):
    """CGAL's mesh with its default criteria, but for the size that gives `wanted` tetrahedra within 5 %."""
    tried, size = {}, 10.0
    for _ in range(MOST_RUNS):
        lines = run(cgal, IMAGE, "-o", mesh, "--facet-size", size, "--cell-size", 1.5 * size, "--facet-distance", size / 4)
        tried[size] = json.loads(lines.strip().splitlines()[-1])["tets"]
        if off(tried[size], wanted) <= SAME_COUNT:
            return
        size = next_size(tried, wanted)
    sys.exit(f"no size of CGAL's gives {wanted} tetrahedra: {tried}")


def judge(program, mesh):
    report = mesh.with_suffix(".json")
    subprocess.run([program, "check", mesh, "--image", IMAGE, "--json", report, "--quiet"], capture_output=True)
    return figures(json.loads(report.read_text(encoding="utf-8"))["assessment"])


def scene_of(mesh, time_step_s, materials, folder):
    """The brain scene with that mesh in the place of the mesher."""
    text = (SCENES / "brain.scn").read_text(encoding="utf-8")
    loader = f'<LabelImageLoader name="mesher" filename="{mesh.resolve()}" {materials}/>'
    text, meshers = re.subn(r"<ImageToTetrahedralMesh.*?/>", loader, text, flags=re.S)
    text, solvers = re.subn(r'iterations="\d+"', 'iterations="20000"', text)
    text, steps = re.subn(r'dt="[^"]*"', f'dt="{time_step_s}"', text, count=1)
    assert meshers == solvers == steps == 1
    path = folder / f"{mesh.stem}_{time_step_s}.scn"
    path.write_text(text, encoding="utf-8")
    return path


def simulate(driver, mesh, time_step_s, steps, folder, materials=MATERIALS):
    lines = run(driver, scene_of(mesh, time_step_s, materials, folder), "--steps", steps)
    return json.loads(next(line for line in lines.splitlines() if line.startswith("{")))


def cell(row):
    iterations = f"{row['iterations']:,.0f}"
    return iterations if row["speed_mm_s"] < AT_REST_MM_S else iterations + " (moves)"


def table(rows):
    first = rows[0]["runs"]["0.02"]
    lines = ["| mesh | tetrahedra | dihedral ° | mean ratio from | smallest Dice | steps a second | " +
             " | ".join(f"{t:g} s" for t in TIME_STEPS_S) + " | one material, 0.02 s |",
             "| --- | ---: | ---: | ---: | ---: | ---: |" + " ---: |" * (len(TIME_STEPS_S) + 1)]
    for row in rows:
        f, runs = row["figures"], row["runs"]
        lines.append(f"| {row['title']} | {f['tets']:,} | {f['dihedral_deg'][0]:.1f}–{f['dihedral_deg'][1]:.1f} | "
                     f"{f['mean_ratio'][0]:.3f} | {f['dice'][0]:.3f} | {runs['0.02']['steps_s']:.1f} | "
                     + " | ".join(cell(runs[f"{t:g}"]) for t in TIME_STEPS_S)
                     + f" | {cell(runs['one material'])} |")
    lines.append("")
    lines.append("The columns with a time step hold the iterations of the conjugate gradient a step, on average over "
                 f"{first['steps']} steps; \"moves\" would stand where the fastest vertex is above {AT_REST_MM_S} mm/s "
                 "after the last one.")
    return "\n".join(lines)


def measure(arguments, program, driver, cgal):
    """One row a mesh."""
    meshes = {"ours": "Anatomesh", "unguarded": "Anatomesh, `--min-dihedral 0`", "cgal": "CGAL"}
    paths = {name: arguments.out / f"{name}.vtu" for name in meshes}
    mesh_ours(program, paths["ours"], "--max-elements", arguments.tets)
    wanted = judge(program, paths["ours"])["tets"]
    mesh_unguarded(program, wanted, paths["unguarded"])
    mesh_with_cgal(cgal, wanted, paths["cgal"])

    rows = []
    for name, title in meshes.items():
        quality = judge(program, paths[name])
        row = {"title": title, "figures": quality, "runs": {}}
        for time_step in TIME_STEPS_S:
            got = simulate(driver, paths[name], time_step, arguments.steps, arguments.out)
            row["runs"][f"{time_step:g}"] = {**got, "steps": arguments.steps}
            print(f"{title}, {time_step} s: {got}", flush=True)
        row["runs"]["one material"] = simulate(driver, paths[name], TIME_STEPS_S[0], arguments.steps, arguments.out, ONE_MATERIAL)
        rows.append(row)
    return rows


def draw_pulled(program, driver, folder):
    """The malformation after 100 steps, cut open."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk
    import numpy as np
    rest, points, pulled = (folder / name for name in ("rest.vtu", "points.txt", "pulled.vtu"))
    run(program, "mesh", SCENES / "malformation.nii.gz", "-o", rest, "--quiet", *PULLED)
    run(driver, SCENES / "malformation.scn", "--steps", 100, "--points", points)
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(rest))
    reader.Update()
    mesh = reader.GetOutput()
    mesh.GetPoints().SetData(numpy_to_vtk(np.loadtxt(points), deep=True))
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(pulled))
    writer.SetInputData(mesh)
    writer.Write()
    run(sys.executable, ROOT / "tools/render_mesh.py", pulled, PICTURE, "--size", 400, "--view", "front")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/ci")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/sofa_steps")
    parser.add_argument("--tets", type=int, default=15000, help="budget of our mesh [15000]")
    parser.add_argument("--steps", type=int, default=40, help="of each run [40]")
    only = parser.add_mutually_exclusive_group()
    only.add_argument("--table", action="store_true")
    only.add_argument("--picture", action="store_true")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    program, driver, cgal = (arguments.build / "bin" / name for name in ("anatomesh", "sofa_steps", "cgal_mesh_3"))

    figures_file = arguments.out / "steps.json"
    if arguments.picture:
        draw_pulled(program, driver, arguments.out)
        return
    if not arguments.table:
        rows = measure(arguments, program, driver, cgal)
        figures_file.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    replace_between(PAGE, BEGIN, END, table(json.loads(figures_file.read_text(encoding="utf-8"))))


if __name__ == "__main__":
    main()
