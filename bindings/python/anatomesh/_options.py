"""The options of the mesher: the members of include/anatomesh/options.h, under their names."""

from __future__ import annotations

import difflib
from typing import Any, Literal, Mapping, Sequence, TypedDict, Union

from . import _core


class Material(TypedDict, total=False):
    """Linear-elastic material of a tissue. Only ratios of moduli matter to the mesh."""

    young_modulus_pa: float  # > 0 [3000]
    poisson_ratio: float  # >= 0, < 0.5 [0.45]


TissueKind = Literal["brain", "ventricle", "tumour", "vessel", "other"]


class Options(TypedDict, total=False):
    """Every option, with its range and its [default]; docs/command-line.md says more of each."""

    bcc_size_mm: float  # spacing of the coarsest lattice, > 0 [0: 8 to 16 times the mean voxel spacing]
    min_size_mm: float  # smallest lattice spacing that fidelity may ask for, > 0 [0: half the mean voxel spacing]
    fidelity: float  # F1 and F2 that each tissue is refined for, 0 < F <= 1 [0.95; 1 with max_elements]
    fidelity_label: Mapping[int, float]  # F of single tissues, by label
    fidelity_stage: Literal["lattice", "final"]  # where fidelity is judged ["final"]
    max_elements: int  # most tetrahedra [0: as many as the fidelity takes]
    size_label: Mapping[int, float]  # longest edge inside single tissues, mm, by label
    elements_across: int  # tetrahedra across a tissue where it is thin, 0 to 16 [0: not asked]
    drop_islands: int  # parts of fewer voxels take the label around them [0: none]
    allow_non_manifold: bool  # leave surfaces that touch themselves [False]
    non_connectivity: Literal["vertex", "edge", "face", "none"]  # thinning of the edge points ["face"]
    iterations: int  # of the registration at most, 0 to 1000 [10]
    min_dihedral_deg: float  # smallest dihedral angle, 0 to 30 [20]
    max_dihedral_deg: float  # largest dihedral angle, 117 to 180 [150]
    min_mean_ratio: float  # smallest mean ratio, 0 to 0.5 [0.3]
    gradation: float  # mm that edges may be longer a mm farther from the interfaces [0: no limit]
    material: Mapping[int, Union[Material, TissueKind]]  # of single tissues, by label
    default_material: Union[Material, TissueKind]  # of the rest
    labels: Sequence[int]  # mesh these only, the rest is background [(): all]
    frame: Literal["lps", "ras"]  # space of the resulting mesh ["lps"]
    order: Literal[1, 2]  # 2: quadratic tetrahedra, whose edge nodes follow the surfaces [1]
    threads: int  # [0: all cores]; the result does not depend on it
    max_memory_gib: float  # refuse a mesh that takes more by estimate [0: the memory that is free]


def default_options() -> dict[str, Any]:
    """Every option with its default."""
    return _core.default_options()


def checked_options(caller: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """The options as the library takes them. Raises TypeError where one does not exist."""
    for name in given:
        if name not in Options.__annotations__:
            near = difflib.get_close_matches(name, Options.__annotations__, 1)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            raise TypeError(f"{caller}() has no option '{name}'{hint}")
    options = dict(given)
    # As on the command line: within a budget, the best fidelity that it allows.
    if options.get("max_elements"):
        options.setdefault("fidelity", 1.0)
    return options
