"""The model as a GLB file, which any 3-D viewer opens."""

import trimesh

from cellctl.planning.pictures.poses import DrawnBody, drawn_bodies
from cellctl.planning.scene.cell_scene import CellScene

_FIXTURE, _ARM, _STAND_IN = (150, 158, 168), (31, 95, 168), (199, 125, 10)


def cell_glb(scene: CellScene) -> bytes:
    """Fixtures grey, arms blue, stand-ins of arms orange, other poses faint; m, z upwards."""
    drawing = trimesh.Scene()
    for body in drawn_bodies(scene):
        body.mesh.visual = trimesh.visual.ColorVisuals(body.mesh, face_colors=_colour(body))
        drawing.add_geometry(body.mesh, node_name=body.name, geom_name=body.name)
    return bytes(drawing.export(file_type="glb"))


def _colour(body: DrawnBody) -> tuple[int, int, int, int]:
    rgb = _FIXTURE if body.solid.arm is None else _STAND_IN if body.solid.stand_in else _ARM
    return (*rgb, 70 if body.ghost else 255)
