"""Label images of other packages, and where they lie in space."""

from __future__ import annotations

import math
import sys
from typing import Any, Callable, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import InvalidInput

Triple = Union[Sequence[float], npt.NDArray[Any]]
Matrix = Union[Sequence[Sequence[float]], npt.NDArray[Any]]
#: Red, green and blue, whole numbers from 0 to 255.
Colour = Sequence[int]
Progress = Callable[[str, float], Optional[bool]]


class Geometry(NamedTuple):
    """Where voxels lie: the centre of [i, j, k] is at origin + direction @ (spacing * (i, j, k)), LPS millimetres."""

    spacing: tuple[float, ...] = (1.0, 1.0, 1.0)
    origin: tuple[float, ...] = (0.0, 0.0, 0.0)
    direction: tuple[tuple[float, ...], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def _numbers(name: str, given: Any, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
    try:
        numbers = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} is {given!r}; it must be an array of numbers of shape {shape}") from None
    if numbers.shape != shape:
        raise InvalidInput(f"{name} has the shape {numbers.shape}; it must be {shape}")
    return numbers


def _spacing_like(length: float, spacing: float) -> float:
    """A column of 32-bit floats has a length that is rounded; the spacing stated beside it is the better number."""
    return spacing if abs(length - spacing) <= 1e-6 * spacing else length


def geometry_of_affine(affine: Any, stated_spacing: Optional[Sequence[float]] = None, mm: float = 1.0) -> Geometry:
    """Of a 4x4 matrix from indices to RAS, in units of `mm`, as nibabel has it."""
    matrix = _numbers("affine", affine, (4, 4)).tolist()
    if matrix[3] != [0.0, 0.0, 0.0, 1.0]:
        raise InvalidInput(f"the last row of affine is {matrix[3]}; it must be [0, 0, 0, 1]")
    # 0.0 -: no negative zeros
    columns = [(0.0 - matrix[0][c], 0.0 - matrix[1][c], matrix[2][c]) for c in range(4)]
    lengths = [math.sqrt(x * x + y * y + z * z) for x, y, z in columns[:3]]
    if not all(0 < length < math.inf for length in lengths):
        raise InvalidInput(f"the columns of affine have the lengths {lengths}; they must be above 0 and finite")
    stated = lengths if stated_spacing is None else stated_spacing
    return Geometry(
        tuple(mm * _spacing_like(length, near) for length, near in zip(lengths, stated)),
        tuple(mm * x for x in columns[3]),
        tuple(tuple(columns[c][row] / lengths[c] for c in range(3)) for row in range(3)),
    )


def _given_geometry(
    spacing: Optional[Triple], origin: Optional[Triple], direction: Optional[Matrix], affine: Optional[Matrix]
) -> Geometry:
    if affine is not None:
        if not (spacing is None and origin is None and direction is None):
            raise InvalidInput("affine is given along with spacing, origin or direction; give one or the others")
        return geometry_of_affine(affine)
    geometry = Geometry()
    if spacing is not None:
        geometry = geometry._replace(spacing=tuple(_numbers("spacing", spacing, (3,)).tolist()))
    if origin is not None:
        geometry = geometry._replace(origin=tuple(_numbers("origin", origin, (3,)).tolist()))
    if direction is not None:
        numbers = np.asarray(direction)
        rows = _numbers("direction", numbers.reshape(3, 3) if numbers.size == 9 else numbers, (3, 3))
        geometry = geometry._replace(direction=tuple(tuple(row) for row in rows.tolist()))
    return geometry


def _of_simpleitk(image: Any) -> tuple[npt.NDArray[Any], Geometry]:
    if image.GetDimension() != 3:
        raise InvalidInput(f"the SimpleITK image has {image.GetDimension()} dimensions; 3 are needed")
    view = sys.modules["SimpleITK"].GetArrayViewFromImage(image)
    return view.T, _given_geometry(image.GetSpacing(), image.GetOrigin(), image.GetDirection(), None)


# Millimetres in the units of length that a NIfTI header may name.
_UNITS_MM = {"meter": 1000.0, "micron": 0.001}


def _is_rotation(geometry: Geometry) -> bool:
    direction = np.array(geometry.direction)
    return bool(np.abs(direction.T @ direction - np.eye(3)).max() <= 1e-4)


def _says_where_it_lies(image: Any) -> bool:
    """Not so: Analyze files, and NIfTI files with neither form, for which nibabel makes up an affine."""
    header = image.header
    if not isinstance(header, sys.modules["nibabel.analyze"].AnalyzeHeader):
        return True
    if any(int(header[code]) > 0 for code in ("qform_code", "sform_code") if code in header):
        return True
    return image.affine is not None and not np.allclose(image.affine, header.get_best_affine())


def _of_nibabel(image: Any) -> tuple[npt.NDArray[Any], Geometry]:
    header = image.header
    mm = _UNITS_MM.get(header.get_xyzt_units()[0], 1.0) if hasattr(header, "get_xyzt_units") else 1.0
    if not _says_where_it_lies(image):  # as the command line takes it: in LPS, from the origin on
        return np.asanyarray(image.dataobj), Geometry(tuple(mm * float(zoom) for zoom in header.get_zooms()[:3]))
    affine = np.asarray(image.affine, dtype=np.float64)
    from_file = np.array_equal(affine, affine.astype(np.float32))
    zooms = [float(zoom) for zoom in header.get_zooms()[:3]] if from_file else None
    geometry = geometry_of_affine(affine, zooms, mm)
    if not _is_rotation(geometry) and hasattr(image, "get_qform"):
        qform = image.get_qform(coded=True)[0]
        if qform is not None:
            geometry = geometry_of_affine(qform, zooms, mm)
    return np.asanyarray(image.dataobj), geometry


# Module and class of images that know where they lie, and what reads them.
_READERS = (
    ("SimpleITK", "Image", _of_simpleitk),
    ("nibabel.spatialimages", "SpatialImage", _of_nibabel),
)


def _reader_of(image: Any) -> Optional[Callable[[Any], tuple[npt.NDArray[Any], Geometry]]]:
    """None for anything else. An object of a class that was never imported cannot be there."""
    for module, name, reader in _READERS:
        if module in sys.modules and isinstance(image, getattr(sys.modules[module], name)):
            return reader
    return None


def require_image_object(image: Any) -> None:
    if _reader_of(image) is None:
        raise TypeError(
            f"{type(image).__name__} is neither a SimpleITK.Image nor an image of nibabel; "
            "give arrays to mesh(), with their spacing, origin and direction or their affine"
        )


def _native(voxels: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Three axes, in this machine's byte order; a view where that is so already."""
    while voxels.ndim > 3 and voxels.shape[-1] == 1:
        voxels = voxels[..., 0]
    if voxels.dtype == np.float16:
        return voxels.astype(np.float32)
    return voxels.astype(voxels.dtype.newbyteorder("="), copy=False)


def label_image(
    image: Any,
    names: Optional[Mapping[int, str]] = None,
    spacing: Optional[Triple] = None,
    origin: Optional[Triple] = None,
    direction: Optional[Matrix] = None,
    affine: Optional[Matrix] = None,
    colours: Optional[Mapping[int, Colour]] = None,
) -> _core.LabelImage:
    """An array [i, j, k] with its geometry, or an image object, which has its own, as the library takes it."""
    reader = _reader_of(image)
    if reader is None:
        voxels, geometry = np.asarray(image), _given_geometry(spacing, origin, direction, affine)
    elif spacing is None and origin is None and direction is None and affine is None:
        voxels, geometry = reader(image)
    else:
        raise InvalidInput(
            f"a {type(image).__name__} says itself where it lies; spacing, origin, direction and affine are for arrays"
        )
    return _core.LabelImage(_native(voxels), *geometry, plain_names(names), plain_colours(colours))


def plain_names(names: Optional[Mapping[int, str]]) -> dict[int, str]:
    for label, name in (names or {}).items():
        if not isinstance(name, str):
            raise InvalidInput(f"the name of label {label!r} is {name!r}; it must be text")
    return dict(names or {})


def plain_colours(colours: Optional[Mapping[int, Colour]]) -> dict[int, tuple[int, int, int]]:
    plain = {}
    for label, colour in (colours or {}).items():
        parts = np.asarray(colour)
        if parts.shape != (3,) or parts.dtype.kind not in "iu" or parts.min() < 0 or parts.max() > 255:
            raise InvalidInput(
                f"the colour of label {label!r} is {colour!r}; it must be red, green and blue, "
                "whole numbers from 0 to 255"
            )
        plain[label] = (int(parts[0]), int(parts[1]), int(parts[2]))
    return plain
