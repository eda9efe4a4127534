"""Draws the clean picture that a camera has of connectors and marks."""

from collections.abc import Iterable

from scipy.spatial.transform import RigidTransform

from fakes.render.connectors.canvas import Canvas, ColouredPatch
from fakes.render.connectors.colours import Pixels
from fakes.render.connectors.dirt import dirt_patch
from fakes.render.connectors.holes import hole_patches
from fakes.render.connectors.look import ConnectorLook
from fakes.render.connectors.marks import draw_plates, mark_patch
from fakes.render.connectors.pins import pin_patch
from fakes.render.connectors.shading import METAL, PLASTIC, Shading
from fakes.render.connectors.surroundings import draw_surroundings
from fakes.render.optics.canvas import Image
from fakes.render.optics.lens import View
from fakes.render.optics.light import light_field
from fakes.world.connector.scene import ConnectorBody, SceneConnector, SceneMarks

_FLOOR_GREY = 10.0


def connector_channels(
    view: View,
    bodies: Iterable[ConnectorBody],
    look: ConnectorLook,
    pixels: Pixels,
    light_seed: int = 0,
) -> tuple[Image, ...]:
    """Grey levels of each channel, without noise, not rounded and not clipped.

    Farther bodies are drawn first; the light is that on the nearest of them.
    """
    ordered = sorted(bodies, key=lambda body: -float(pose_of(body).translation[2]))
    canvas = Canvas.filled(view, pixels, _FLOOR_GREY)
    patches: list[ColouredPatch | None] = []
    for body in ordered:
        match body:
            case SceneConnector():
                draw_surroundings(canvas, view, body, look)
                patches += _contacts(view, body, look)
                pose = body.camera_T_connector
                patches += [dirt_patch(view, pose, speck, look) for speck in body.dirt]
            case SceneMarks():
                draw_plates(canvas, view, body, look)
                patches += [mark_patch(view, body, mark, look) for mark in body.marks]
    if not ordered:
        return canvas.channels
    light = light_field(view, pose_of(ordered[-1]), light_seed, look.sensor)
    finished = canvas.lit_and_blurred(light, view.lens.blur_px)
    for patch in patches:
        if patch is not None:
            finished.lay_over(patch, light)
    return finished.channels


def pose_of(body: ConnectorBody) -> RigidTransform:
    """Pose of a body in the frame of the camera."""
    return body.camera_T_connector if isinstance(body, SceneConnector) else body.camera_T_marks


def _contacts(
    view: View, connector: SceneConnector, look: ConnectorLook
) -> list[ColouredPatch | None]:
    pose = connector.camera_T_connector
    if connector.kind == "pins":
        metal = Shading.of(look.lamps, METAL, pose)
        return [pin_patch(view, connector, pin, look, metal) for pin in connector.contacts]
    plastic = Shading.of(look.lamps, PLASTIC, pose)
    return [
        patch
        for hole in connector.contacts
        for patch in hole_patches(view, connector, hole, look, plastic)
    ]
