"""Labelled tetrahedral meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Mapping, Optional

import numpy as np
import numpy.typing as npt

from . import _core
from ._image import Colour, Matrix, Progress, Triple, label_image, plain_colours, plain_names
from .errors import InvalidInput

if TYPE_CHECKING:
    from collections.abc import Sequence

# Names that meshes of other programs give to the array of their labels, ours first.
_LABEL_ARRAYS = ("label", "labels", "medit:ref", "gmsh:physical", "material")


@dataclass(frozen=True)
class TissueOutcome:
    """What became of one tissue of the image."""

    label: int
    voxels: int  #: in the image
    tets: int  #: in the mesh; 0: the tissue could not be represented
    fidelity: float  #: the F asked for
    lattice_f1: float  #: F1 reached on the undeformed lattice (0 to 1)
    lattice_f2: float  #: F2 reached on the undeformed lattice (0 to 1)
    f1: float  #: F1 of the final mesh (0 to 1)
    f2: float  #: F2 of the final mesh (0 to 1)


@dataclass(frozen=True, eq=False)
class Interface:
    """The faces between the tetrahedra of two labels, or between one label and the outside."""

    inside: int  #: the smaller label; the faces are those of its tetrahedra
    outside: int  #: the larger one; 0: nothing, the faces lie on the skin
    triangles: npt.NDArray[np.uint32]  #: (n, 3): vertices, anticlockwise as seen from outside
    tets: npt.NDArray[np.uint32]  #: (n,): the tetrahedron of each face, ascending
    opposite: npt.NDArray[np.uint8]  #: (n,): the corner (0 to 3) of that tetrahedron that the face lies opposite to


class Mesh:
    """A conforming tetrahedral mesh.

    `points`, `tets`, `labels` and `edge_nodes` are read-only views of the mesh itself, which they keep alive; nothing is copied.
    Every tetrahedron (a, b, c, d) of a mesh made by this package has a positive volume, (b-a) x (c-a) . (d-a) / 6.
    """

    #: Outcome of every tissue of the image, by label. Empty where the mesh was not made by this package.
    tissues: dict[int, TissueOutcome]
    #: Sentences for the user, e.g. a tissue that could not be represented.
    warnings: list[str]
    #: Wall-clock seconds of each stage.
    times: dict[str, float]
    #: The options as used: sizes that were 0 are filled in.
    options: dict[str, Any]

    def __init__(
        self,
        points: npt.ArrayLike,
        tets: npt.ArrayLike,
        labels: Optional[npt.ArrayLike] = None,
        names: Optional[Mapping[int, str]] = None,
        colours: Optional[Mapping[int, Colour]] = None,
        edge_nodes: Optional[npt.ArrayLike] = None,
    ) -> None:
        """A mesh of arrays, which are copied: (n, 3) points in mm, (m, 4) vertices, (m,) labels (all 1 without).

        Quadratic tetrahedra also have (m, 6) edge_nodes.
        """
        tets = _whole_numbers("tets", tets)
        labels = np.ones(len(tets), np.uint32) if labels is None else _whole_numbers("labels", labels)
        table = plain_names(names), plain_colours(colours)
        nodes = np.zeros((0, 6), np.uint32) if edge_nodes is None else _whole_numbers("edge_nodes", edge_nodes)
        self._mesh = _core.TetMesh(np.asarray(points, np.float64), tets, labels, nodes, *table)
        self._describe({})

    @classmethod
    def _made(cls, result: Mapping[str, Any]) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._mesh = result["mesh"]
        mesh._describe(result)
        return mesh

    def _describe(self, result: Mapping[str, Any]) -> None:
        self.tissues = {tissue["label"]: TissueOutcome(**tissue) for tissue in result.get("tissues", ())}
        self.warnings = result.get("warnings", [])
        self.times = result.get("times", {})
        self.options = result.get("options", {})

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """(n, 3) float64: vertices in millimetres, in the frame of the options (LPS unless asked for RAS)."""
        return self._mesh.points

    @property
    def tets(self) -> npt.NDArray[np.uint32]:
        """(m, 4) uint32: the vertices of each tetrahedron."""
        return self._mesh.tets

    @property
    def labels(self) -> npt.NDArray[np.uint32]:
        """(m,) uint32: the tissue of each tetrahedron."""
        return self._mesh.labels

    @property
    def edge_nodes(self) -> npt.NDArray[np.uint32]:
        """(m, 6) uint32: points on the edges (0,1) (1,2) (2,0) (0,3) (1,3) (2,3) of quadratic tetrahedra, else (0, 6)."""
        return self._mesh.edge_nodes

    @property
    def order(self) -> int:
        """1: linear tetrahedra, 2: quadratic ones."""
        return 2 if len(self.edge_nodes) else 1

    @property
    def cells(self) -> npt.NDArray[np.uint32]:
        """(m, 4) or (m, 10) uint32: all nodes of each tetrahedron, in the order of VTK."""
        return np.hstack([self.tets, self.edge_nodes]) if self.order == 2 else self.tets

    def with_order(self, order: Literal[1, 2]) -> Mesh:
        """A new mesh of linear or quadratic tetrahedra, see the option `order`, within the bounds of this one's."""
        if order not in (1, 2):
            raise ValueError(f"order is {order!r}; it must be 1 or 2")
        options = {**_core.default_options(), **self.options, "order": order}
        bounds = options["min_dihedral_deg"], options["max_dihedral_deg"]
        mesh = Mesh._made({"mesh": _core.with_order(self._mesh, order, *bounds)})
        mesh.tissues, mesh.warnings, mesh.times = self.tissues, self.warnings, self.times
        mesh.options = {**self.options, "order": order} if self.options else {}
        return mesh

    @property
    def names(self) -> dict[int, str]:
        """What labels stand for, where that is known."""
        return self._mesh.names

    @property
    def colours(self) -> dict[int, tuple[int, int, int]]:
        """Red, green and blue of labels, 0 to 255, where they are known."""
        return self._mesh.colours

    def interfaces(self) -> list[Interface]:
        """The surfaces where two tissues meet and the outer skin, each face once, sorted by inside, then outside."""
        return [Interface(*arrays) for arrays in _core.interfaces_of(self._mesh)]

    def assess(
        self,
        image: Any = None,
        /,
        *,
        spacing: Optional[Triple] = None,
        origin: Optional[Triple] = None,
        direction: Optional[Matrix] = None,
        affine: Optional[Matrix] = None,
        labels: Optional[Sequence[int]] = None,
        frame: Optional[str] = None,
        distances: bool = True,
        min_dihedral_deg: Optional[float] = None,
        max_dihedral_deg: Optional[float] = None,
        min_mean_ratio: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> dict[str, Any]:
        """Measures the mesh, against the image it was made of if that is given (as mesh() takes it).

        Returns what `anatomesh check --json` writes under "assessment" (None for what was not measured), and
        "failed_guarantees", one sentence for each. `labels` (the rest of the image is background), `frame` and the
        bounds are those that the mesh was made with unless given. Surface distances take most of the time.
        """
        voxels = None
        if image is not None:
            voxels = label_image(image, None, spacing, origin, direction, affine)
            kept = list(self.options.get("labels", ()) if labels is None else labels)
            if kept:
                voxels.keep_labels(kept)

        def own(name: str, given: Any) -> Any:
            return self.options.get(name, _core.default_options()[name]) if given is None else given

        return _core.assess(
            self._mesh,
            voxels,
            own("frame", frame),
            distances,
            own("min_dihedral_deg", min_dihedral_deg),
            own("max_dihedral_deg", max_dihedral_deg),
            own("min_mean_ratio", min_mean_ratio),
            progress,
        )

    def to_meshio(self) -> Any:
        """A meshio.Mesh with the cell data "label", whose write() knows many formats.

        Names go into field_data, as Gmsh has them: {name: [label, 3]}, which has no place for colours.
        """
        import meshio

        return meshio.Mesh(
            self.points,
            [("tetra10" if self.order == 2 else "tetra", self.cells.astype(np.int64))],  # as meshio's writers expect
            cell_data={"label": [self.labels]},
            field_data={name: np.array([label, 3]) for label, name in self.names.items()},
        )

    def to_pyvista(self) -> Any:
        """A pyvista.UnstructuredGrid with the cell data "label"; names and colours are in field_data.

        As in our .vtu files, colours only where every label that has a name or a colour has one.
        """
        import pyvista
        from vtkmodules.vtkCommonCore import vtkStringArray

        kind = pyvista.CellType.QUADRATIC_TETRA if self.order == 2 else pyvista.CellType.TETRA
        grid = pyvista.UnstructuredGrid({kind: self.cells.astype(np.int64)}, np.array(self.points))
        grid.cell_data["label"] = np.array(self.labels)
        described = sorted({*self.names, *self.colours})
        if described:
            grid.field_data["label_values"] = np.array(described, np.uint32)
            names = vtkStringArray()  # pyvista's own takes ASCII only
            names.SetName("label_names")
            for known in described:
                names.InsertNextValue(self.names.get(known, ""))
            grid.GetFieldData().AddArray(names)
        if described and set(described) == set(self.colours):
            grid.field_data["label_colours"] = np.array([self.colours[known] for known in described], np.uint8)
        return grid

    @classmethod
    def from_meshio(cls, mesh: Any, label: Optional[str] = None) -> Mesh:
        """The tetrahedra of a meshio.Mesh, all linear or all quadratic, in its order and orientation.

        Labels come from the cell data of the name `label`; unless given, of the first of "label", "labels",
        "medit:ref", "gmsh:physical" and "material" that is there; without any, all labels are 1. Names come from
        field_data, as Gmsh has them or, with colours, as our .vtu files do.
        """
        kinds = {block.type for block in mesh.cells} & {"tetra", "tetra10"}
        if len(kinds) != 1:
            found = "both" if kinds else "neither"
            raise InvalidInput(f"the mesh has {found} of the cells 'tetra' and 'tetra10'; one kind of them is needed")
        blocks = [n for n, block in enumerate(mesh.cells) if block.type in kinds]
        cells = np.concatenate([mesh.cells[n].data for n in blocks])
        tets, nodes = cells[:, :4], cells[:, 4:] if "tetra10" in kinds else None
        name = label or next((known for known in _LABEL_ARRAYS if known in mesh.cell_data), None)
        if name is None:
            return cls(mesh.points, tets, edge_nodes=nodes)
        if name not in mesh.cell_data:
            raise InvalidInput(f"the mesh has no cell data '{name}'; it has {sorted(mesh.cell_data)}")
        labels = np.concatenate([mesh.cell_data[name][n] for n in blocks])
        return cls(mesh.points, tets, labels, *_table_of_meshio(mesh), edge_nodes=nodes)

    def __reduce__(self) -> tuple[Any, ...]:
        described = {
            "tissues": [vars(tissue) for tissue in self.tissues.values()],
            "warnings": self.warnings,
            "times": self.times,
            "options": self.options,
        }
        arrays = np.array(self.points), np.array(self.tets), np.array(self.labels), np.array(self.edge_nodes)
        return _remade, (*arrays, self.names, self.colours, described)

    def __repr__(self) -> str:
        return (
            f"<anatomesh.Mesh: {len(self.points)} vertices, {len(self.tets)} tetrahedra, "
            f"{len(np.unique(self.labels))} labels>"
        )


def _table_of_meshio(mesh: Any) -> tuple[dict[int, str], dict[int, tuple[int, int, int]]]:
    """Names and colours of our .vtu files, or the names of volumes as Gmsh has them; of anything else nothing."""
    fields = {name: np.atleast_1d(entry) for name, entry in mesh.field_data.items()}
    if {"label_values", "label_names"} <= set(fields):
        labels = [int(label) for label in fields["label_values"].ravel()]
        texts = fields["label_names"].astype(np.uint8).tobytes().decode("utf-8", "replace").split("\0")
        colours = fields.get("label_colours", np.zeros((0, 3)))
        rows = colours.reshape(-1, 3) if colours.size == 3 * len(labels) else ()
        names = {label: text for label, text in zip(labels, texts) if text}
        return names, {label: (int(r), int(g), int(b)) for label, (r, g, b) in zip(labels, rows)}
    groups = {name: e for name, e in fields.items() if e.shape == (2,) and e.dtype.kind in "iu" and e[1] == 3}
    return {int(e[0]): name for name, e in groups.items()}, {}


def _whole_numbers(name: str, given: npt.ArrayLike) -> npt.NDArray[np.uint32]:
    numbers = np.asarray(given)
    with np.errstate(invalid="ignore"):
        whole = numbers.astype(np.uint32)
    if numbers.dtype.kind not in "biuf" or not np.array_equal(whole, numbers):
        raise InvalidInput(f"{name} holds other than whole numbers from 0 to 4294967295")
    return whole


def _remade(
    points: npt.ArrayLike,
    tets: npt.ArrayLike,
    labels: npt.ArrayLike,
    edge_nodes: npt.ArrayLike,
    names: dict[int, str],
    colours: dict[int, tuple[int, int, int]],
    described: dict[str, Any],
) -> Mesh:
    mesh = Mesh(points, tets, labels, names, colours, edge_nodes)
    mesh._describe(described)
    return mesh
