#!/usr/bin/env python3
"""Compares Anatomesh with CGAL's Mesh_3 at the same number of tetrahedra, and writes docs/comparison.md.

usage: compare_peers.py [--data FOLDER ...] [--images NAME ...] [--refresh ours|peers|all] [--table]

For each image: our mesh with default options; CGAL's with the sizes, found by at most --runs runs, that give as many
tetrahedra (within 10 %), once plain and once with its label weights. `anatomesh check` judges all of them. The figures
are kept in docs/comparison.json and the table of docs/comparison.md is made from them, so that single images can be
measured again: an image that has figures is left as it is, unless --refresh says what to measure again (`ours` takes
the peers' figures along as long as they are within 10 %). --table only rewrites the page.

CGAL's sizes are one number h in mm: facets of h, tetrahedra of 1.5 h, facets within h / 4 of the surface; its other
parameters are those of its examples. Build with -DANATOMESH_BUILD_PEERS=ON first.
"""
import argparse
import datetime
import json
import math
import os
import pathlib
import re
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
from measured_run import run_limited  # noqa: E402
from mesh_figures import LARGE_TISSUE_VOX, SMALL_TISSUE_VOX, figures  # noqa: E402
from pages import replace_between  # noqa: E402

MRICRON = pathlib.Path("/usr/share/mricron/templates")

# image: spacing of our coarsest lattice in mean voxel spacings, where it is not the default
IMAGES = {"crtc_i2m_ventricles.nii.gz": None, "crtc_i2m_nidus.nii.gz": None, "crtc_i2m_brain.nii.gz": None,
          "medmpd_p3_brain_ventricles_1mm_LIA.nii.gz": None, "medmpd_p2_intracranial_ventricles_vessels.nii.gz": None,
          "totalseg_example_seg.nii.gz": None, "aal.nii.gz": None, "brats2013_p1_brain_tumor.nii.gz": None,
          "cleaver_mickey.nrrd": None, "niivue_torsoLabel.nii.gz": None, "seg3d_brain_skull.nii.gz": None,
          "spl_brain_hncma_atlas.nrrd": None, "spl_knee_seg.nrrd": None, "fvb_mouse_exvivo_oblique.nii.gz": None,
          "allen_human_2020.nii.gz": None, "gubra_mouse_brain_large_uint32.nii.gz": 32}

PEERS = {"cgal": [], "cgal_weights": ["--weights"]}
TITLES = {"ours": "**Anatomesh**", "cgal": "CGAL", "cgal_weights": "CGAL, weights"}

SAME_COUNT = 0.10  # of our number of tetrahedra
BEGIN, END = "<!-- comparison:begin -->", "<!-- comparison:end -->"


# Measuring

def judge(program, mesh, image, log):
    """The figures of the table, from `anatomesh check`."""
    out = mesh.with_suffix(".check.json")
    out.unlink(missing_ok=True)
    run_limited([program, "check", mesh, "--image", image, "--json", out, "--quiet"], log)
    if not out.exists():
        return {"failed": "the mesh could not be checked"}
    return figures(json.loads(out.read_text(encoding="utf-8"))["assessment"])


def spacing_of(program, image):
    text = subprocess.run([program, "info", image], check=True, capture_output=True, text=True).stdout
    return [float(x) for x in re.search(r"^spacing mm\s+(.*)$", text, re.M).group(1).split()]


def failure(done, timeout_s, log):
    if done.timed_out:
        return f"no mesh in {timeout_s:.0f} s"
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return (lines[-1][:120] if lines else "no message") + f" (exit status {done.status})"


def measure_ours(arguments, image, spacing_mm, folder):
    mesh, log = folder / "ours.vtu", folder / "ours.log"
    log.unlink(missing_ok=True)
    options = shlex.split(arguments.options)
    if "--bcc-size" not in options and (times := IMAGES.get(image.name)):
        options += ["--bcc-size", f"{times * sum(spacing_mm) / 3:.6g}"]
    done = run_limited([arguments.program, "mesh", image, "-o", mesh, "--quiet", *options], log, arguments.timeout,
                       arguments.memory)
    if done.status != 0:
        return {"failed": failure(done, arguments.timeout, log)}
    return {**judge(arguments.program, mesh, image, log), "cpu_s": done.cpu_s, "wall_s": done.wall_s,
            "memory_mb": done.memory_mb, "options": " ".join(options)}


def run_cgal(arguments, image, size_mm, options, mesh, log):
    """The driver's line of JSON, or {"failed": why, "timed_out": bool}."""
    log.unlink(missing_ok=True)
    done = run_limited([arguments.cgal, image, "-o", mesh, "--facet-size", f"{size_mm:.6g}", "--cell-size",
                        f"{1.5 * size_mm:.6g}", "--facet-distance", f"{size_mm / 4:.6g}", *options], log,
                       arguments.timeout, arguments.memory)
    if done.status != 0:
        return {"failed": failure(done, arguments.timeout, log), "timed_out": done.timed_out}
    return json.loads(log.read_text(encoding="utf-8").strip().splitlines()[-1])


def next_size(tried, wanted):
    """The next size to try: where log(tetrahedra), as a function of log(size), should be `wanted`. `tried` maps
    sizes to counts; None is a run without end, whose size was too small."""
    counts = {size: count for size, count in tried.items() if count is not None}
    too_small = max([size for size, count in tried.items() if count is None or count > wanted], default=0)
    too_large = min([size for size, count in counts.items() if count <= wanted], default=math.inf)
    if not counts:
        return 1.6 * too_small
    near = sorted(counts, key=lambda size: abs(math.log(counts[size] / wanted)))[:2]
    slope = -2.5
    if len(near) == 2 and counts[near[0]] != counts[near[1]]:
        slope = math.log(counts[near[0]] / counts[near[1]]) / math.log(near[0] / near[1])
        slope = min(max(slope, -4.0), -0.8)
    size = near[0] * (wanted / counts[near[0]]) ** (1 / slope)
    if too_small < size < too_large:
        return size
    return math.sqrt(too_small * too_large) if 0 < too_small < too_large < math.inf else size


def measure_cgal(arguments, image, wanted, first_size, options, folder, name):
    """CGAL's mesh of about `wanted` tetrahedra: the nearest of at most `runs` runs."""
    best, tried, size = None, {}, first_size
    mesh, log = folder / f"{name}.vtu", folder / f"{name}.log"
    for _ in range(arguments.runs):
        result = run_cgal(arguments, image, size, options, folder / "trial.vtu", log)
        print(f"    {name}: size {size:.3f} mm: {result.get('failed') or format(result['tets'], ',')}", flush=True)
        tried[size] = result.get("tets")
        if "failed" in result and (not result["timed_out"] or list(tried.values()).count(None) == 2):
            break
        if "tets" in result and (best is None or off(result["tets"], wanted) < off(best["tets"], wanted)):
            best = {**result, "size_mm": size}
            os.replace(folder / "trial.vtu", mesh)
            if off(best["tets"], wanted) <= SAME_COUNT / 2:
                break
        size = next_size(tried, wanted)
    if best is None:
        return {"failed": result["failed"]}
    taken = {key: best[key] for key in ("cpu_s", "wall_s", "memory_mb", "size_mm", "cgal")}
    return {**judge(arguments.program, mesh, image, log), **taken}


def off(count, wanted):
    return abs(count / wanted - 1)


def measure_image(arguments, image, row):
    """Fills in what the row of an image lacks or --refresh asks for."""
    folder = arguments.out / image.name.split(".")[0]
    folder.mkdir(parents=True, exist_ok=True)
    print(image.name, flush=True)
    row["spacing_mm"] = spacing_of(arguments.program, image)
    if "ours" not in row or arguments.refresh in ("ours", "all"):
        row["ours"] = measure_ours(arguments, image, row["spacing_mm"], folder)
        print(f"    ours: {row['ours'].get('failed') or format(row['ours']['tets'], ',')}", flush=True)
    if "failed" in row["ours"]:
        return
    wanted = row["ours"]["tets"]
    for name, options in PEERS.items():
        old = row.get(name, {})
        if old and arguments.refresh not in ("peers", "all") and ("failed" in old or off(old["tets"], wanted) <= SAME_COUNT):
            continue
        first = 1.3 * (row["ours"]["image_volume_mm3"] / wanted) ** (1 / 3)
        if "size_mm" in old:
            first = old["size_mm"] * (old["tets"] / wanted) ** 0.4
        row[name] = measure_cgal(arguments, image, wanted, first, options, folder, name)
    row["date"] = datetime.date.today().isoformat()


# The page

def better_at(peer, ours):
    """In what a peer's mesh beats ours."""
    words = []
    if peer["normal_jump_deg"] < ours["normal_jump_deg"]:
        words.append("smoother")
    if peer["surface_mm"][0] is not None and peer["surface_mm"][0] < ours["surface_mm"][0]:
        words.append("nearer")
    if peer["dihedral_deg"][0] > ours["dihedral_deg"][0] and peer["dihedral_deg"][1] < ours["dihedral_deg"][1]:
        words.append("better-angled")
    return words


def number(value, digits):
    return "–" if value is None else f"{value:,.{digits}f}"


def pair(values, digits):
    return " / ".join(number(v, digits) for v in values)


COLUMNS = [  # title, how to show it
    ("tetrahedra", lambda f: f"{f['tets']:,}"),
    ("dihedral °", lambda f: f"{f['dihedral_deg'][0]:.1f}–{f['dihedral_deg'][1]:.1f}"),
    ("1 % °", lambda f: number(f["dihedral_p1_deg"], 1)),
    ("mean ratio min / mean", lambda f: pair(f["mean_ratio"], 2)),
    ("Dice min / mean", lambda f: pair(f["dice"], 3)),
    ("distance mean / 95 % mm", lambda f: pair(f["surface_mm"], 2)),
    ("surface angle °", lambda f: number(f["normal_jump_deg"], 1)),
    ("nm edges / vertices", lambda f: "{:,} / {:,}".format(*f["nonmanifold"])),
    ("wrong parts", lambda f: f"{f['wrong_parts']} of {f['tissues']}"),
    ("labels lost", lambda f: str(f["missing_labels"])),
    ("volume %", lambda f: "–" if f["large_volume_percent"] is None else f"{f['large_volume_percent']:+.1f}"),
    ("CPU s", lambda f: number(f["cpu_s"], 1)),
    ("MB", lambda f: number(f["memory_mb"], 0)),
]


def table_row(image, key, row):
    found = row.get(key, {"failed": "not measured"})
    cells = [image, TITLES[key] + (f" `{found['options']}`" if found.get("options") else "")]
    if "failed" in found:
        return "| " + " | ".join([*cells, found["failed"].replace("|", "/")] + [""] * len(COLUMNS)) + " |\n"
    cells += [show(found) for _, show in COLUMNS] + [""]
    if key != "ours" and "tets" in row.get("ours", {}):
        words = better_at(found, row["ours"])
        cells[-1] = "**all three**" if len(words) == 3 else ", ".join(words) or "nothing"
        cells[2] += " (!)" if off(found["tets"], row["ours"]["tets"]) > SAME_COUNT else ""
    return "| " + " | ".join(cells) + " |\n"


def comparison_table(rows):
    titles = ["image", "mesh", *(title for title, _ in COLUMNS), "peer is better at"]
    text = "| " + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|\n"
    for image in ordered(rows):
        for key in TITLES:
            text += table_row(image.split(".")[0] if key == "ours" else "", key, rows[image])
    return text


PROMISES = [  # title, what must hold of our figures and the voxel spacing, what to show
    ("20°–150°", lambda f, s: f["dihedral_deg"][0] >= 20 and f["dihedral_deg"][1] <= 150,
     lambda f, s: f"{f['dihedral_deg'][0]:.1f}–{f['dihedral_deg'][1]:.1f}"),
    ("1 % ≥ 22°", lambda f, s: f["dihedral_p1_deg"] >= 22, lambda f, s: number(f["dihedral_p1_deg"], 1)),
    ("mean ratio ≥ 0.3", lambda f, s: f["mean_ratio"][0] >= 0.3, lambda f, s: number(f["mean_ratio"][0], 3)),
    ("distance mean ≤ 0.3 voxels", lambda f, s: at_most(f["large_surface_mm"][0], 0.3 * max(s)),
     lambda f, s: in_voxels(f["large_surface_mm"][0], s)),
    ("95 % ≤ 1 voxel", lambda f, s: at_most(f["large_surface_mm"][1], max(s)),
     lambda f, s: in_voxels(f["large_surface_mm"][1], s)),
    ("volume ±1 %", lambda f, s: at_most(f["large_volume_percent"], 1),
     lambda f, s: number(f["large_volume_percent"], 1)),
    ("manifold", lambda f, s: f["nonmanifold"] == [0, 0], lambda f, s: "{} / {}".format(*f["nonmanifold"])),
    ("parts", lambda f, s: f["wrong_parts"] == 0, lambda f, s: str(f["wrong_parts"])),
    ("labels", lambda f, s: f["missing_labels"] == 0, lambda f, s: str(f["missing_labels"])),
]


def at_most(value, bound):
    return value is None or abs(value) <= bound


def in_voxels(value, spacing_mm):
    return number(None if value is None else value / max(spacing_mm), 2)


def promises_table(rows):
    text = "| image | " + " | ".join(title for title, _, _ in PROMISES) + " |\n" + "|---" * (len(PROMISES) + 1) + "|\n"
    for image in ordered(rows):
        ours, spacing = rows[image].get("ours", {"failed": ""}), rows[image]["spacing_mm"]
        if "failed" in ours:
            continue
        cells = [show(ours, spacing) if holds(ours, spacing) else f"**{show(ours, spacing)}**" for _, holds, show in PROMISES]
        text += f"| {image.split('.')[0]} | " + " | ".join(cells) + " |\n"
    return text


def ordered(rows):
    known = list(IMAGES)
    return sorted(rows, key=lambda name: (known.index(name) if name in known else len(known), name))


def page(rows):
    versions = sorted({row[p]["cgal"] for row in rows.values() for p in PEERS if "cgal" in row.get(p, {})})
    dates = sorted(row["date"] for row in rows.values() if "date" in row)
    compared = [(image, p) for image in ordered(rows) for p in PEERS
                if all("tets" in rows[image].get(mesh, {}) for mesh in ("ours", p))]
    lost = [f"{TITLES[p]} on {image.split('.')[0]}" for image, p in compared
            if len(better_at(rows[image][p], rows[image]["ours"])) == 3]
    verdict = ("On no image is a peer's mesh at once smoother, nearer and better-angled than ours." if not lost else
               "At once smoother, nearer and better-angled than ours: " + "; ".join(lost) + ".")
    measured = f"CGAL {', '.join(versions) or '(none)'}; measured {dates[0]} to {dates[-1]}." if dates else ""
    return f"\n{verdict} {measured}\n\n{comparison_table(rows)}\n## What we promise\n\nOur meshes against the promises; " \
           f"what is not kept is in bold. Distances and volumes: the worst tissue of more than {LARGE_TISSUE_VOX:,} voxels; " \
           f"parts: tissues of more than {SMALL_TISSUE_VOX} voxels.\n\n{promises_table(rows)}"


def find_images(folders):
    """Path of every image of the table that is on this machine."""
    found = {}
    for folder in [*folders, MRICRON]:
        for name in IMAGES:
            if (folder / name).exists():
                found.setdefault(name, folder / name)
    return found


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, nargs="+", default=[ROOT.parent / "shared" / "data"],
                        help="folders of images; Debian's mricron templates are known")
    parser.add_argument("--images", nargs="+", help="only these: parts of their file names")
    parser.add_argument("--refresh", choices=["ours", "peers", "all"])
    parser.add_argument("--table", action="store_true", help="measure nothing, only rewrite the page")
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/bin/anatomesh")
    parser.add_argument("--cgal", type=pathlib.Path, help="[cgal_mesh_3 beside the program]")
    parser.add_argument("--options", default="", help="further options of `anatomesh mesh`, in quotation marks")
    parser.add_argument("--runs", type=int, default=8, help="most runs of a peer an image [8]")
    parser.add_argument("--timeout", type=float, default=600, help="seconds a run [600]")
    parser.add_argument("--memory", type=float, default=default_memory_gib(), help="GiB a run [3/4 of the machine's]")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build/comparison", help="meshes and logs")
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "docs/comparison.md")
    arguments = parser.parse_args()
    arguments.cgal = arguments.cgal or arguments.program.with_name("cgal_mesh_3")
    return arguments


def default_memory_gib():
    return 0.75 * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30


def main():
    arguments = parse_arguments()
    record = arguments.page.with_suffix(".json")
    rows = json.loads(record.read_text(encoding="utf-8")) if record.exists() else {}
    images = {} if arguments.table else find_images(arguments.data)
    if arguments.images:
        images = {name: path for name, path in images.items() if any(part in name for part in arguments.images)}
        if not images and not arguments.table:
            sys.exit(f"compare_peers: no image of {', '.join(arguments.images)} is on this machine")
    for name, path in images.items():
        row = rows.setdefault(name, {})
        measure_image(arguments, path, row)
        record.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
        replace_between(arguments.page, BEGIN, END, page(rows))
    if arguments.table:
        replace_between(arguments.page, BEGIN, END, page(rows))


if __name__ == "__main__":
    main()
