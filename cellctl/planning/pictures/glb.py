"""The model as a GLB file, which any 3-D viewer opens."""

from collections.abc import Sequence

import trimesh

from cellctl.planning.pictures.frusta import Frustum
from cellctl.planning.pictures.paths import FlangePath
from cellctl.planning.pictures.poses import DrawnBody, drawn_bodies
from cellctl.planning.scene.cell_scene import CellScene

_FIXTURE, _ARM, _STAND_IN = (150, 158, 168), (31, 95, 168), (199, 125, 10)
_VIEW = (46, 125, 50)
_FAINT = 70


def cell_glb(scene: CellScene, views: Sequence[Frustum], paths: Sequence[FlangePath]) -> bytes:
    """Fixtures grey, arms blue, stand-ins of arms orange, other poses faint, what heads see green.

    Ways of the flanges are lines. In m, z upwards.
    """
    drawing = trimesh.Scene()
    for body in drawn_bodies(scene):
        body.mesh.visual = trimesh.visual.ColorVisuals(body.mesh, face_colors=_colour(body))
        drawing.add_geometry(body.mesh, node_name=body.name, geom_name=body.name)
    for view in views:
        mesh = view.mesh()
        mesh.visual = trimesh.visual.ColorVisuals(mesh, face_colors=(*_VIEW, _FAINT))
        drawing.add_geometry(mesh, node_name=view.name, geom_name=view.name)
    for path in paths:
        line = trimesh.load_path(path.points_m)
        drawing.add_geometry(line, node_name=path.name, geom_name=path.name)
    return bytes(drawing.export(file_type="glb"))


def _colour(body: DrawnBody) -> tuple[int, int, int, int]:
    rgb = _FIXTURE if body.solid.arm is None else _STAND_IN if body.solid.stand_in else _ARM
    return (*rgb, _FAINT if body.ghost else 255)
