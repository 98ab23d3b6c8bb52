"""Plots of the figures that suite.py and file_to_file.py have measured, into docs/images."""
import json
import statistics

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402
from matplotlib.ticker import FormatStrFormatter, NullFormatter  # noqa: E402

# Colours that colour-blind people can tell apart (Okabe and Ito).
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000"]
MARKERS = "osD^vPx"
STAGES = ["lattice", "approach", "finish", "fidelity", "assess", "image_to_mesh"]
WHOLE = ["image_to_mesh", "image_to_mesh_large"]
BASE = {"side": "128", "labels": "4", "bcc": "800", "threads": "2"}
DPI = 110


def series(figures, stages, varied):
    """Figures of cases that differ from BASE in one argument only, by stage, in ascending order of it."""
    chosen = {}
    for f in figures.values():
        if f["stage"] in stages and all(f[key] == BASE[key] for key in BASE if key not in varied):
            chosen.setdefault(f["stage"], []).append(f)
    return {stage: sorted(chosen[stage], key=lambda f: [int(f[key]) for key in varied]) for stage in stages
            if stage in chosen}


def lines(axes, by_stage, x):
    for n, (stage, cases) in enumerate(by_stage.items()):
        axes.plot([x(f) for f in cases], [f["ms"] / 1000 for f in cases], marker=MARKERS[n], color=COLOURS[n],
                  label=stage, linewidth=1.2, markersize=4)
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FormatStrFormatter("%g"))
        axis.set_minor_formatter(NullFormatter())
    axes.set_ylabel("seconds, 2 threads")
    axes.grid(alpha=0.3)


def draw_growth(axes, figures):
    whole = sorted((f for f in figures.values() if f["stage"] in WHOLE and f["tets"] and f["threads"] == "2"),
                   key=lambda f: f["tets"])
    axes.loglog([f["tets"] for f in whole], [f["ms"] / 1000 for f in whole], "o", color=COLOURS[0], markersize=4,
                label="whole way, all images")
    if whole:
        rate = statistics.median(f["tets"] / f["ms"] for f in whole)
        ends = [whole[0]["tets"], whole[-1]["tets"]]
        axes.loglog(ends, [n / rate / 1000 for n in ends], color="0.5", linewidth=1,
                    label=f"linear: {1000 * rate:,.0f} a second")
    axes.set_xlabel("tetrahedra of the result")
    axes.set_ylabel("seconds, 2 threads")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)


def draw_stages(docs, figures):
    """docs: the folder of the page. figures: by case its arguments, as strings, with ms, tets and memory_mb."""
    figure, axes = pyplot.subplots(2, 2, figsize=(9, 7), layout="constrained")
    draw_growth(axes[0][0], figures)
    lines(axes[0][1], series(figures, STAGES, ["bcc"]), lambda f: int(f["bcc"]) / 100)
    axes[0][1].set_xlabel("lattice spacing in voxels (of 2.1 million, 4 labels)")
    in_proportion = {name: f for name, f in figures.items() if f["side"] == BASE["side"] and f["bcc"] == BASE["bcc"]
                     or int(f["bcc"]) == 8 * int(f["side"])}
    lines(axes[1][0], series(in_proportion, STAGES + ["labels"], ["side", "bcc"]), lambda f: int(f["side"]) ** 3 / 1e6)
    axes[1][0].set_xlabel("million voxels (lattice in proportion, 4 labels)")
    lines(axes[1][1], series(figures, STAGES, ["labels"]), lambda f: int(f["labels"]))
    axes[1][1].set_xlabel("labels (image of 2.1 million voxels, lattice of 8)")
    axes[1][0].legend(fontsize=7, ncols=2)
    figure.savefig(docs / "images" / "speed-stages.png", dpi=DPI)
    pyplot.close(figure)


def draw_files(docs):
    """From the figures that file_to_file.py keeps beside its page."""
    figures = json.loads((docs / "speed_files.json").read_text(encoding="utf-8"))
    figure, axes = pyplot.subplots(figsize=(9, 0.9 + 1.1 * len(figures)), layout="constrained")
    meshers = list(next(iter(figures.values())))
    for n, mesher in enumerate(meshers):
        rates = [f[mesher]["tets"] / statistics.median(f[mesher]["seconds"]) for f in figures.values()]
        bars = axes.barh([i + 0.2 * n for i in range(len(figures))], rates, 0.18, color=COLOURS[n], label=mesher)
        axes.bar_label(bars, [f"{rate:,.0f}" for rate in rates], fontsize=7, padding=2)
    axes.set_yticks([i + 0.1 * (len(meshers) - 1) for i in range(len(figures))], list(figures), fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel("tetrahedra a second, image file to mesh file")
    axes.legend(fontsize=7)
    axes.margins(x=0.12)
    figure.savefig(docs / "images" / "speed-files.png", dpi=DPI)
    pyplot.close(figure)
