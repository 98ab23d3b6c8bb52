#!/usr/bin/env python3
"""Pictures of a labelled mesh, cut open and coloured by tissue. Needs python3-vtk9, and a display or xvfb-run.

usage: render_mesh.py MESH.vtu PICTURE.png [--size PIXELS] [--view all|NAME] [--no-edges]

Whole tetrahedra are taken away in front of a plane through the middle ("crinkle cut"), so that the elements inside
show as they are. `--view all` puts four cuts side by side; a single view is named left, front, top or corner.
"""
import argparse
import colorsys
import os
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

# name: direction from which one looks, up; in LPS. What lies on the viewer's side of the middle is cut away.
VIEWS = {
    "left": ((1.0, 0.0, 0.0), (0, 0, 1)),
    "front": ((0.0, -1.0, 0.0), (0, 0, 1)),
    "top": ((0.0, 0.0, 1.0), (0, -1, 0)),
    "corner": ((0.75, -0.6, 0.45), (0, 0, 1)),
}

FINER = 3  # drawn this many times larger and averaged, so that the edges of small elements do not cover them


def read_mesh(path):
    reader = vtk.vtkXMLUnstructuredGridReader() if path.endswith(".vtu") else vtk.vtkUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    if mesh.GetNumberOfCells() == 0 or not mesh.GetCellData().HasArray("label"):
        sys.exit(f"render_mesh: {path} has no tetrahedra with a cell array 'label'")
    return mesh


def tissue_colours(count):
    """Distinct colours: hues a golden angle apart, in three brightnesses."""
    hues = (0.08 + 0.61803398875 * np.arange(count)) % 1
    shades = [(0.55, 0.92), (0.75, 0.78), (0.40, 0.98)]
    return np.array([colorsys.hsv_to_rgb(hue, *shades[i % 3]) for i, hue in enumerate(hues)])


def colour_by_tissue(mesh):
    labels = vtk_to_numpy(mesh.GetCellData().GetArray("label"))
    values, index = np.unique(labels, return_inverse=True)
    colours = (255 * tissue_colours(len(values))[index]).astype(np.uint8)
    array = numpy_to_vtk(colours, deep=True)
    array.SetName("colour")
    mesh.GetCellData().AddArray(array)
    mesh.GetCellData().SetActiveScalars("colour")


def cut_open(mesh, direction, origin=None):
    """The surface of the tetrahedra that lie behind the plane through `origin`, or else through the middle."""
    plane = vtk.vtkPlane()
    plane.SetOrigin(origin if origin is not None else mesh.GetCenter())
    plane.SetNormal(direction)
    behind = vtk.vtkExtractGeometry()
    behind.SetInputData(mesh)
    behind.SetImplicitFunction(plane)
    behind.ExtractInsideOn()
    behind.ExtractBoundaryCellsOn()
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputConnection(behind.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


def renderer_for(surface, direction, up, edges):
    """Draws faces in their colours, seen from `direction`; the caller sets up the rest of the camera."""
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetColorModeToDirectScalars()
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray("colour")
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetAmbient(0.35)
    look.SetDiffuse(0.7)
    look.SetEdgeVisibility(edges)
    look.SetEdgeColor(0.15, 0.15, 0.18)
    look.SetLineWidth(1)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(direction)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(up)
    camera.ParallelProjectionOn()
    return renderer


def show_all(renderer, bounds, zoom):
    renderer.ResetCamera(bounds)
    renderer.GetActiveCamera().Zoom(zoom)
    renderer.ResetCameraClippingRange()


def show_ball(renderer, centre, radius):
    """Fills the picture's height with a ball, whose middle the camera looks at."""
    renderer.ResetCamera()  # moves the camera out of what is drawn
    camera = renderer.GetActiveCamera()
    away = 3 * (np.array(camera.GetPosition()) - np.array(camera.GetFocalPoint()))
    camera.SetFocalPoint(centre)
    camera.SetPosition(np.array(centre) + away)
    camera.SetParallelScale(radius)
    renderer.ResetCameraClippingRange()


def draw(renderers, size):
    """One picture of renderers two by two (a single one alone), as a vtkImageData; `size`: pixels of a side of each."""
    columns = 2 if len(renderers) > 1 else 1
    rows = (len(renderers) + columns - 1) // columns
    window = vtk.vtkRenderWindow()
    window.OffScreenRenderingOn()
    window.SetMultiSamples(0)
    window.SetSize(size * columns * FINER, size * rows * FINER)
    for number, renderer in enumerate(renderers):
        column, row = number % columns, rows - 1 - number // columns
        renderer.SetViewport(column / columns, row / rows, (column + 1) / columns, (row + 1) / rows)
        window.AddRenderer(renderer)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    if vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).std() < 1:
        sys.exit("render_mesh: the picture is empty; is there an OpenGL (libgl1-mesa-dri) and a display (xvfb-run)?")
    shrink = vtk.vtkImageShrink3D()
    shrink.SetInputConnection(grab.GetOutputPort())
    shrink.SetShrinkFactors(FINER, FINER, 1)
    shrink.MeanOn()
    shrink.Update()
    return shrink.GetOutput()


def render(mesh, views, size, edges, path):
    renderers = []
    for view in views:
        direction, up = VIEWS[view]
        renderers.append(renderer_for(cut_open(mesh, direction), direction, up, edges))
        show_all(renderers[-1], mesh.GetBounds(), 1.35 if view != "corner" else 1.25)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputData(draw(renderers, size))
    writer.Write()


def with_display():
    """Starts again under xvfb-run where there is no display: Debian's VTK draws through X."""
    if os.environ.get("DISPLAY"):
        return
    arguments = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", sys.executable] + sys.argv
    try:
        os.execvp(arguments[0], arguments)
    except FileNotFoundError:
        sys.exit("render_mesh: no display and no xvfb-run (package xvfb)")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("mesh")
    parser.add_argument("picture")
    parser.add_argument("--size", type=int, default=800, help="pixels of a view's side")
    parser.add_argument("--view", choices=["all"] + list(VIEWS), default="all")
    parser.add_argument("--no-edges", action="store_true")
    arguments = parser.parse_args()
    with_display()
    mesh = read_mesh(arguments.mesh)
    colour_by_tissue(mesh)
    views = list(VIEWS) if arguments.view == "all" else [arguments.view]
    render(mesh, views, arguments.size, not arguments.no_edges, arguments.picture)


if __name__ == "__main__":
    main()
