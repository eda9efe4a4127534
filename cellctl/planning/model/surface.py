"""Reads the surface of a body from a file and refuses one that would give wrong distances."""

from pathlib import Path

import trimesh

from cellctl.errors.config import MeshNotUsable, SizeImplausible
from cellctl.geometry.pose import MM
from cellctl.planning.model.document import MeshKeys
from cellctl.planning.model.shapes import MeshShape

_SMALLEST_M, _LARGEST_M = 0.005, 20.0
_UNITS_M = {"mm": MM, "m": 1.0}


def read_surface(keys: MeshKeys, folder: Path) -> MeshShape:
    """The surface in m, in the frame of its file; raises ``MeshNotUsable``, ``SizeImplausible``."""
    path = folder / keys.file
    try:
        mesh = trimesh.load_mesh(path, process=True)
    except (OSError, ValueError, KeyError, NotImplementedError, IndexError, TypeError) as error:
        raise MeshNotUsable(f"{path}: {error}") from error
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
        raise MeshNotUsable(f"{path}: no triangles in it")
    if not mesh.is_watertight:
        raise MeshNotUsable(f"{path}: the surface is not closed")
    mesh.apply_scale(_UNITS_M[keys.unit])
    longest_m = float(mesh.extents.max())
    if not _SMALLEST_M <= longest_m <= _LARGEST_M:
        raise SizeImplausible(
            f"{path}: {longest_m:g} m long when its figures are {keys.unit}, "
            f"expected {_SMALLEST_M:g} to {_LARGEST_M:g} m"
        )
    return MeshShape(mesh)
