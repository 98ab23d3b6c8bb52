# The extension module; see bindings/python/src.
from typing import Any, Callable, Mapping, Optional, Sequence

import numpy as np
import numpy.typing as npt

version: str

_Progress = Optional[Callable[[str, float], Optional[bool]]]

class TetMesh:
    def __init__(
        self,
        points: npt.ArrayLike,
        tets: npt.ArrayLike,
        labels: npt.ArrayLike,
        edge_nodes: npt.ArrayLike,
        names: Mapping[int, str],
        colours: Mapping[int, tuple[int, int, int]],
    ) -> None: ...
    @property
    def points(self) -> npt.NDArray[np.float64]: ...
    @property
    def tets(self) -> npt.NDArray[np.uint32]: ...
    @property
    def labels(self) -> npt.NDArray[np.uint32]: ...
    @property
    def edge_nodes(self) -> npt.NDArray[np.uint32]: ...
    @property
    def names(self) -> dict[int, str]: ...
    @property
    def colours(self) -> dict[int, tuple[int, int, int]]: ...

class LabelImage:
    def __init__(
        self,
        voxels: npt.NDArray[Any],
        spacing: Sequence[float],
        origin: Sequence[float],
        direction: Sequence[Sequence[float]],
        names: Mapping[int, str],
        colours: Mapping[int, tuple[int, int, int]],
    ) -> None: ...
    def keep_labels(self, labels: Sequence[int]) -> None: ...

class Remesher:
    def __init__(self, image: LabelImage, options: Mapping[str, Any], progress: _Progress) -> None: ...
    def update(self, changed: LabelImage, progress: _Progress) -> dict[str, Any]: ...
    def result(self) -> dict[str, Any]: ...

def image_to_mesh(image: LabelImage, options: Mapping[str, Any], progress: _Progress) -> dict[str, Any]: ...
def default_options() -> dict[str, Any]: ...
def with_order(mesh: TetMesh, order: int, min_dihedral_deg: float, max_dihedral_deg: float) -> TetMesh: ...
def interfaces_of(
    mesh: TetMesh,
) -> list[tuple[int, int, npt.NDArray[np.uint32], npt.NDArray[np.uint32], npt.NDArray[np.uint8]]]: ...
def assess(
    mesh: TetMesh,
    image: Optional[LabelImage],
    frame: str,
    distances: bool,
    min_dihedral_deg: float,
    max_dihedral_deg: float,
    min_mean_ratio: float,
    progress: _Progress,
) -> dict[str, Any]: ...
