"""From label images to meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Mapping, Optional

from . import _core
from ._image import Colour, Matrix, Progress, Triple, label_image, require_image_object
from ._mesh import Mesh
from ._options import checked_options

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import Options


def mesh(
    image: Any,
    /,
    *,
    spacing: Optional[Triple] = None,
    origin: Optional[Triple] = None,
    direction: Optional[Matrix] = None,
    affine: Optional[Matrix] = None,
    names: Optional[Mapping[int, str]] = None,
    colours: Optional[Mapping[int, Colour]] = None,
    progress: Optional[Progress] = None,
    **options: Unpack[Options],
) -> Mesh:
    """Meshes every tissue of a label image.

    `image` is an array of labels, indexed [i, j, k]: its first axis is the one of spacing[0] and of the first column of
    direction or affine. That is the order of nibabel. SimpleITK's GetArrayFromImage() and most NRRD and TIFF readers
    give [k, j, i]: hand over array.T, which copies nothing. Labels are whole numbers of any type, 0 is background.

    Where it lies is said either by `affine`, a 4x4 matrix from indices to RAS millimetres as nibabel has it, or by
    `spacing`, `origin` and `direction` (3x3, a column for each axis) in LPS millimetres as ITK has them. An image of
    SimpleITK or nibabel says so itself (see mesh_image()). The mesh is in LPS whatever the image was given in;
    frame="ras" puts it where nibabel's coordinates are.

    `names` are the names of labels, `colours` their red, green and blue, 0 to 255. `progress(stage, fraction)` is called
    now and then on the calling thread; once it returns False, or raises, the work stops. Ctrl-C stops it, too. Other
    threads of Python go on meanwhile.

    The options are those of `Options`. The same image and options give the same bytes as the command line.

    Raises InvalidInput, InvalidOption, MeshingFailed, Cancelled; TypeError for an option that does not exist.
    """
    voxels = label_image(image, names, spacing, origin, direction, affine, colours)
    return Mesh._made(_core.image_to_mesh(voxels, checked_options("mesh", options), progress))


def mesh_image(
    image: Any,
    /,
    *,
    names: Optional[Mapping[int, str]] = None,
    colours: Optional[Mapping[int, Colour]] = None,
    progress: Optional[Progress] = None,
    **options: Unpack[Options],
) -> Mesh:
    """Meshes a SimpleITK.Image or an image of nibabel, which says itself where it lies; else as mesh()."""
    require_image_object(image)
    return mesh(image, names=names, colours=colours, progress=progress, **options)


@dataclass(frozen=True)
class UpdateReport:
    """What an update of a mesh has done."""

    changed_voxels: int  #: with another label than before
    new_tets: int  #: tetrahedra made anew; all others are what they were, to the last bit
    whole: bool  #: all of the mesh was made anew, as mesh() does it
    reason: str  #: why, where it was: one sentence; else empty
    seconds: float  #: wall-clock time


class Remesher:
    """Meshes an image and then follows changes of its labels by meshing anew only what is near them.

    Takes what mesh() takes. One call at a time: another thread that comes in between gets an Error.
    """

    def __init__(
        self,
        image: Any,
        /,
        *,
        spacing: Optional[Triple] = None,
        origin: Optional[Triple] = None,
        direction: Optional[Matrix] = None,
        affine: Optional[Matrix] = None,
        names: Optional[Mapping[int, str]] = None,
        colours: Optional[Mapping[int, Colour]] = None,
        progress: Optional[Progress] = None,
        **options: Unpack[Options],
    ) -> None:
        self._geometry = (spacing, origin, direction, affine)
        self._names, self._colours = names, colours
        voxels = label_image(image, names, *self._geometry, colours)
        self._remesher = _core.Remesher(voxels, checked_options("Remesher", options), progress)
        self._mesh: Optional[Mesh] = None

    def update(self, changed: Any, /, *, progress: Optional[Progress] = None) -> UpdateReport:
        """Brings the mesh up to date with the whole changed image, which lies where the first one did.

        Raises what mesh() does; the mesh is then what it was before. Meshes handed out before stay as they are.
        """
        voxels = label_image(changed, self._names, *self._geometry, self._colours)
        report = self._remesher.update(voxels, progress)
        self._mesh = None
        return UpdateReport(**report)

    @property
    def mesh(self) -> Mesh:
        """The mesh as it is now; a copy, made at the first look after an update."""
        if self._mesh is None:
            self._mesh = Mesh._made(self._remesher.result())
        return self._mesh
