#!/usr/bin/env python3
"""Makes the pictures of docs/surfaces.md and writes them, with their figures, into the page.

usage: make_docs_pictures.py [--program PATH] [--only NAME ...] [--keep FOLDER] [--list]

A brain (AAL, Debian's mricron-data, by lobes, every third voxel) and a vessel tree (tools/make_vessel_tree.py) are meshed once for each set
of options in the table below. A picture whose options the program does not know yet is left out, with a message. Needs
python3-vtk9, python3-matplotlib, python3-nibabel and python3-pil, and a display or xvfb-run. --keep holds the meshes
of an earlier run of the same program, so that only the pictures are drawn again.
"""
import argparse
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import typing

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
import numpy as np  # noqa: E402
import PIL.Image  # noqa: E402
import vtk  # noqa: E402
from vtk.util.numpy_support import vtk_to_numpy  # noqa: E402

from make_vessel_tree import VESSEL, vessel_tree, write_nifti  # noqa: E402
from measured_run import run_limited  # noqa: E402
from mesh_figures import figures  # noqa: E402
from pages import replace_between  # noqa: E402
from render_mesh import colour_by_tissue, cut_open, draw, read_mesh, renderer_for, show_ball, with_display  # noqa: E402
from render_slices import cut, draw as draw_slice, index_points, interface_triangles, read_image  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/surfaces.md"
AAL = pathlib.Path("/usr/share/mricron/templates/aal.nii.gz")

LARGEST_PICTURE_BYTES = 120_000
LARGEST_TOTAL_BYTES = 1_500_000
PANEL_PIXELS = 360
COLOURS = (64, 48, 32, 24, 16, 8)  # of the palette: as many as the size allows


class View(typing.NamedTuple):
    """What a panel shows. Places are in voxels, the radius too."""
    kind: str  # "surface" from outside, "cut" open, or "slice" of the image with outlines
    place: tuple
    radius: float
    direction: tuple = (0.0, -1.0, 0.0)  # from which one looks, LPS
    up: tuple = (0, 0, 1)
    only: typing.Optional[int] = None  # this tissue alone
    axis: int = 2                      # of a slice


VIEWS = {
    "brain": {"cut": View("cut", (34, 36, 28), 26),
              "slice": View("slice", (37, 36, 25), 15)},
    "vessels": {"surface": View("surface", (53, 53, 56), 59, (0.3, -1.0, 0.2), only=VESSEL),
                "near": View("surface", (53, 53, 36), 20, (0.3, -1.0, 0.2), only=VESSEL),
                "cut": View("cut", (53, 53, 36), 36),
                "slice": View("slice", (53, 53, 34), 26, axis=1)},
}


class Picture(typing.NamedTuple):
    """A row of panels, one a set of options, and the sentence below."""
    name: str
    image: str
    view: str
    options: tuple
    caption: str


# "" are the default options: their mesh is made once.
PICTURES = [
    Picture("fidelity-brain", "brain", "slice", ("--fidelity 0.8", "--fidelity 0.9", ""),
            "Outlines of the mesh over a slice of the image. A higher fidelity takes smaller elements to where the mesh is wrong."),
    Picture("fidelity-vessels", "vessels", "surface", ("--fidelity 0.8", "", "--fidelity 0.98"),
            "The vessels alone, at fidelities of 0.8, 0.95 (the default) and 0.98."),
    Picture("label-vessels", "vessels", "cut", ("--fidelity 0.8", "--fidelity 0.8 --fidelity-label 2=0.97"),
            "A coarse mesh of the block, and the same with a fidelity of its own for the vessels."),
    Picture("stage-brain", "brain", "slice", ("--fidelity-stage lattice", ""),
            "The same fidelity asked of the undeformed lattice, as in the paper, and of the final mesh."),
    Picture("stage-vessels", "vessels", "surface", ("--fidelity-stage lattice", ""),
            "The same for the vessels."),
    Picture("budget-brain", "brain", "cut", ("--max-elements 50000", "--max-elements 80000", ""),
            "The best mesh found within a budget of elements, and the mesh without one."),
    Picture("budget-vessels", "vessels", "surface", ("--max-elements 24000", "--max-elements 32000", ""),
            "A budget spends its elements where most voxels are wrong."),
    Picture("sizes-brain", "brain", "cut", ("--bcc-size 48 --min-size 12", "--bcc-size 48 --min-size 6", ""),
            "`--bcc-size` is the size of the coarsest elements before collapses, `--min-size` that of the smallest at the tissues' borders."),
    Picture("sizes-vessels", "vessels", "surface", ("--min-size 2.4", "--min-size 1.2", ""),
            "A vessel needs elements smaller than it is thick."),
    Picture("size-label-vessels", "vessels", "cut", ("", "--size-label 2=1.5", "--size-label 1=5"),
            "The longest edge, in mm, inside one tissue: nothing asked, the vessels', the block's."),
    Picture("across-vessels", "vessels", "near", ("", "--elements-across 2", "--elements-across 3"),
            "Elements across the local thickness of the vessels: nothing asked, two and three."),
    Picture("gradation-vessels", "vessels", "cut", ("", "--gradation 1", "--gradation 0.25"),
            "By how many mm edges may be longer for each mm farther from the surfaces: no limit, 1 and 0.25."),
    Picture("iterations-brain", "brain", "slice",
            ("--fidelity-stage lattice --iterations 0", "--fidelity-stage lattice --iterations 1", "--fidelity-stage lattice"),
            "A lattice, and how the deformation takes it to where the tissues meet; outlines over a slice of the image."),
    Picture("iterations-vessels", "vessels", "near",
            ("--fidelity-stage lattice --iterations 0", "--fidelity-stage lattice --iterations 1", "--fidelity-stage lattice"),
            "The same at the first branchings."),
    Picture("pattern-vessels", "vessels", "near", ("--non-connectivity none", "", "--non-connectivity vertex"),
            "Targets of the deformation: all of them, thinned by faces (the default) and by vertices."),
    Picture("angles-vessels", "vessels", "near", ("--min-dihedral 5 --max-dihedral 175", "", "--min-dihedral 25 --max-dihedral 140"),
            "Bounds of 5° and 175°, 20° and 150° (the default), 25° and 140°."),
    Picture("manifold-vessels", "vessels", "surface", ("--allow-non-manifold", ""),
            "Every tissue's surface is made a closed manifold unless that is switched off."),
    Picture("islands-vessels", "vessels", "surface", ("", "--drop-islands 30"),
            "The specks beside the vessels, and the mesh without parts of fewer than 30 voxels."),
]


# Images and meshes

# First and last area of AAL that belong to a lobe or a group of nuclei: frontal, insula, cingulum, hippocampus with amygdala,
# occipital, temporal, parietal, striatum with pallidum, thalamus, temporal again, cerebellum.
LOBES = ((1, 28, 1), (29, 30, 2), (31, 36, 3), (37, 42, 4), (43, 54, 5), (55, 56, 6), (57, 70, 7), (71, 76, 8), (77, 78, 9), (79, 90, 6),
         (91, 116, 10))


def lobes(areas):
    lobe_of_area = np.zeros(256, np.uint8)
    for first, last, lobe in LOBES:
        lobe_of_area[first:last + 1] = lobe
    return lobe_of_area[areas]


def inside_filled(voxels):
    """Background with tissue on all six sides, however far, becomes a tissue of its own."""
    enclosed = np.ones(voxels.shape, bool)
    for axis in range(3):
        for way in (1, -1):
            order = tuple(slice(None, None, way) if a == axis else slice(None) for a in range(3))
            enclosed[order] &= np.logical_or.accumulate(voxels[order] != 0, axis=axis)
    return np.where((voxels == 0) & enclosed, voxels.max() + 1, voxels)


def write_images(folder):
    """The two images. The brain has every third voxel of AAL, so of 3 mm, and what AAL leaves out inside as one tissue."""
    voxels, _ = read_image(AAL)
    images = {"brain": folder / "brain.nii.gz", "vessels": folder / "vessels.nii.gz"}
    write_nifti(images["brain"], inside_filled(lobes(voxels[::-3, ::-3, ::3].astype(np.uint8))), 3.0)  # from RAS to LPS
    write_nifti(images["vessels"], vessel_tree(0.6), 0.6)
    return images


def known_options(program):
    text = subprocess.run([program, "mesh", "--help"], check=True, capture_output=True, text=True).stdout
    return set(re.findall(r"--[a-z][a-z-]*", text))


def unknown_options(picture, known):
    asked = {word for options in picture.options for word in shlex.split(options) if word.startswith("--")}
    return sorted(asked - known)


def make_mesh(program, image, options, folder):
    """(mesh file, figures) of one set of options; meshes that lie in the folder already are taken."""
    name = re.sub(r"[^\w.=-]+", "_", f"{image.name.split('.')[0]} {options}".strip())
    mesh, check, log = (folder / (name + end) for end in (".vtu", ".json", ".log"))
    if not (mesh.exists() and check.exists()):
        done = run_limited([program, "mesh", image, "-o", mesh, "--quiet", *shlex.split(options)], log)
        if done.status != 0:
            sys.exit(f"make_docs_pictures: mesh {options}: status {done.status}\n" + log.read_text(encoding="utf-8"))
        run_limited([program, "check", mesh, "--image", image, "--json", check, "--quiet"], log)
    return mesh, figures(json.loads(check.read_text(encoding="utf-8"))["assessment"])


# Panels

def one_tissue(mesh, label):
    choose = vtk.vtkThreshold()
    choose.SetInputData(mesh)
    choose.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_CELLS, "label")
    choose.SetThresholdFunction(vtk.vtkThreshold.THRESHOLD_BETWEEN)
    choose.SetLowerThreshold(label)
    choose.SetUpperThreshold(label)
    choose.Update()
    return choose.GetOutput()


def outer_faces(mesh):
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputData(mesh)
    surface.Update()
    return surface.GetOutput()


def drawn_panel(mesh_file, view, affine):
    """The pixels of a view in space."""
    mesh = read_mesh(str(mesh_file))
    if view.only is not None:
        mesh = one_tissue(mesh, view.only)
    colour_by_tissue(mesh)
    centre = affine[:3, :3] @ np.array(view.place) + affine[:3, 3]
    faces = cut_open(mesh, view.direction, centre) if view.kind == "cut" else outer_faces(mesh)
    renderer = renderer_for(faces, view.direction, view.up, edges=True)
    show_ball(renderer, centre, view.radius * np.cbrt(abs(np.linalg.det(affine[:3, :3]))))
    pixels = draw([renderer], PANEL_PIXELS)
    width, height, _ = pixels.GetDimensions()
    return vtk_to_numpy(pixels.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3]


def slice_panel(axes, mesh_file, view, voxels, affine):
    mesh = read_mesh(str(mesh_file))
    segments = cut(index_points(mesh, affine), interface_triangles(mesh), view.axis, view.place[view.axis])
    draw_slice(axes, voxels, np.linalg.norm(affine[:3, :3], axis=0), segments, view.axis, np.array(view.place), view.radius)


def save_picture(picture, meshes, image, path):
    """One row of panels, in as many colours as the size allows."""
    view = VIEWS[picture.image][picture.view]
    voxels, affine = read_image(image)
    figure, panels = plt.subplots(1, len(meshes), figsize=(len(meshes) * PANEL_PIXELS / 100, PANEL_PIXELS / 100 + 0.25),
                                  dpi=100, squeeze=False)
    for panel, mesh, options in zip(panels[0], meshes, picture.options):
        if view.kind == "slice":
            slice_panel(panel, mesh, view, voxels.astype(np.int64), affine)
        else:
            panel.imshow(drawn_panel(mesh, view, affine))
        panel.set_title(options or "default options", fontsize=9)
        panel.set_xticks([])
        panel.set_yticks([])
    figure.tight_layout(pad=0.6)
    figure.canvas.draw()
    pixels = PIL.Image.fromarray(np.asarray(figure.canvas.buffer_rgba())[:, :, :3])
    plt.close(figure)
    for colours in COLOURS:
        pixels.quantize(colours, dither=PIL.Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size <= LARGEST_PICTURE_BYTES:
            return
    sys.exit(f"make_docs_pictures: {path} has {path.stat().st_size:,} bytes, more than {LARGEST_PICTURE_BYTES:,}")


# The page

def caption(picture, measured):
    text = f"![{picture.caption}](images/surfaces/{picture.name}.png)\n\n{picture.caption}\n\n"
    text += ("| options | tetrahedra | Dice min / mean | distance mean / 95 % mm | surface angle | dihedral | nm edges / vertices |\n"
             "|---|---|---|---|---|---|---|\n")
    for options, f in zip(picture.options, measured):
        shown = f"`{options}`" if options else "default"
        text += (f"| {shown} | {f['tets']:,} | {f['dice'][0]:.3f} / {f['dice'][1]:.3f} | {f['surface_mm'][0]:.3f} / "
                 f"{f['surface_mm'][1]:.2f} | {f['normal_jump_deg']:.1f}° | {f['dihedral_deg'][0]:.1f}° to "
                 f"{f['dihedral_deg'][1]:.1f}° | {f['nonmanifold'][0]:,} / {f['nonmanifold'][1]:,} |\n")
    return text


def marks(name):
    return f"<!-- {name}:begin -->", f"<!-- {name}:end -->"


def make_picture(picture, program, images, folder):
    image = images[picture.image]
    made = [make_mesh(program, image, options, folder) for options in picture.options]
    path = PAGE.parent / "images/surfaces" / f"{picture.name}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    save_picture(picture, [mesh for mesh, _ in made], image, path)
    replace_between(PAGE, *marks(picture.name), caption(picture, [measured for _, measured in made]))
    print(f"{picture.name}: {path.stat().st_size:,} bytes", flush=True)


def check_total():
    total = sum(path.stat().st_size for path in (PAGE.parent / "images/surfaces").glob("*.png"))
    print(f"all pictures together: {total:,} bytes")
    if total > LARGEST_TOTAL_BYTES:
        sys.exit(f"make_docs_pictures: that is more than {LARGEST_TOTAL_BYTES:,}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/bin/anatomesh")
    parser.add_argument("--only", nargs="+", help="pictures whose name contains one of these")
    parser.add_argument("--keep", type=pathlib.Path, help="folder of the meshes [a temporary one]")
    parser.add_argument("--list", action="store_true", help="name the pictures and what they need, and make none")
    arguments = parser.parse_args()

    if not arguments.list:
        with_display()
    known = known_options(arguments.program)
    chosen = [p for p in PICTURES if not arguments.only or any(part in p.name for part in arguments.only)]
    for picture in [p for p in chosen if unknown_options(p, known)]:
        print(f"{picture.name}: left out, {arguments.program.name} has no {', '.join(unknown_options(picture, known))}")
    chosen = [p for p in chosen if not unknown_options(p, known)]
    if arguments.list:
        print("\n".join(p.name for p in chosen))
        return
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        images = write_images(folder)
        for picture in chosen:
            make_picture(picture, arguments.program, images, folder)
    check_total()


if __name__ == "__main__":
    main()
