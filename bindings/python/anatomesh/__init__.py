"""Segmented medical images to multi-tissue tetrahedral meshes.

    import anatomesh, nibabel
    mesh = anatomesh.mesh_image(nibabel.load("brain.nii.gz"))
    mesh.to_meshio().write("brain.vtu")

mesh() takes NumPy arrays, mesh_image() images of SimpleITK and nibabel; Remesher follows an image that changes.
"""

from ._core import version as __version__
from ._image import Progress
from ._mesh import Interface, Mesh, TissueOutcome
from ._meshing import Remesher, UpdateReport, mesh, mesh_image
from ._options import Material, Options, default_options
from .errors import Cancelled, Error, InvalidInput, InvalidOption, MeshingFailed

__all__ = [
    "Cancelled",
    "Error",
    "Interface",
    "InvalidInput",
    "InvalidOption",
    "Material",
    "Mesh",
    "MeshingFailed",
    "Options",
    "Progress",
    "Remesher",
    "TissueOutcome",
    "UpdateReport",
    "__version__",
    "default_options",
    "mesh",
    "mesh_image",
]
