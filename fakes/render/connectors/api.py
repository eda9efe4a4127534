"""Rendered pictures of connectors with their exact truth, for tests and benchmarks.

    from fakes.render.connectors import api

    camera = api.nominal_camera(um_per_px=25.0, blur_px=1.0)
    plug = api.connector_as_made("micro-d-15", "pins", seed=3, missing=("8",),
                                 bent_m={"4": (0.15e-3, 0.0)},
                                 camera_T_connector=api.facing(yaw_deg=12.0))
    marks = api.gripper_marks(api.facing(yaw_deg=12.3))
    look = api.ConnectorLook(lamps=api.Lamps(one_sided=0.3))
    picture = api.render(camera, (plug, marks), look, pixels="rgb", seed=7)
    picture.image                                  # (1200, 1920, 3) uint8
    picture.connectors["micro-d-15"].contacts["4"].px, .camera_m, .state

The same seed gives the same picture. Frames are those of ``fakes.world.connector.drawing``: z
out of the mating face, towards the camera; the origin at the height where the full section of the
pins begins below their chamfers or domes, or of the face with the holes.

What is modelled
- pins as solids: flat tip with a 45° chamfer or half an ellipsoid, the wall that is seen off the
  axis or when the pin leans, bent, missing, true position, brightness of each pin;
- sockets: funnel, bore with its wall, the end of the contact in it, blocked holes;
- a D-shaped shell with both its walls, the insulator, a brushed housing, dirt, marks in a plane of
  their own;
- a ring of lamps at a polar angle, brighter on one side by a share, or a lamp at one side only:
  Lambert and one lobe about the half vector, by the normal of each surface;
- lens with distortion, blur from fine cells, uneven light, read and shot noise, eight bits; one
  channel, three, or a Bayer mosaic (RGGB), where noise belongs to each pixel.

What is not: shadows and reflections between surfaces (``wall_light`` and ``hole_light`` stand for
them), how reflections change with the place in the image (the camera is taken as far away for
light, not for geometry), depth of focus, colour errors of the lens, scratches on tips, more than
one material for pins. Outlines of shell and housing are good to a tenth of a
pixel; contacts and marks to a thousandth.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.render.connectors.colours import Pixels, put_together
from fakes.render.connectors.look import ConnectorLook, Lamps
from fakes.render.connectors.picture import connector_channels
from fakes.render.connectors.truth import (
    ConnectorTruth,
    ContactTruth,
    MarkTruth,
    contact_truths,
    mark_truths,
)
from fakes.render.optics.lens import views_of
from fakes.render.optics.sensor import exposed
from fakes.world.connector.made import connector_as_made, gripper_marks
from fakes.world.connector.scene import ConnectorBody, SceneConnector, SceneMarks
from fakes.world.scene import LensTruth, MonoTruth

__all__ = [
    "ConnectorLook",
    "ConnectorPicture",
    "ConnectorTruth",
    "ContactTruth",
    "Lamps",
    "MarkTruth",
    "connector_as_made",
    "facing",
    "gripper_marks",
    "nominal_camera",
    "render",
]

PIXEL_M = 3.45e-6
WORKING_DISTANCE_M = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class ConnectorPicture:
    """One exposure and what is true about it."""

    image: NDArray[np.uint8]
    """Shape (rows, columns), with three channels for ``rgb``."""
    camera: MonoTruth
    connectors: dict[str, ConnectorTruth]
    marks: dict[str, MarkTruth]


def nominal_camera(
    *,
    um_per_px: float = 25.0,
    size_px: tuple[int, int] = (1920, 1200),
    blur_px: float = 0.8,
    distortion: tuple[float, float, float, float, float] = (-0.08, 0.05, 2e-4, -1e-4, 0.0),
    gain: float = 1.0,
) -> MonoTruth:
    """A camera 250 mm before the tips; ``um_per_px`` there, in the middle of the image."""
    focal_px = WORKING_DISTANCE_M / (um_per_px * 1e-6)
    middle = ((size_px[0] - 1) / 2 + 6.3, (size_px[1] - 1) / 2 - 4.7)
    lens = LensTruth((focal_px, focal_px * 1.0003), middle, distortion, blur_px, gain)
    return MonoTruth(size_px, lens, colour=True)


def facing(
    *,
    shift_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    yaw_deg: float = 0.0,
    tilt_deg: tuple[float, float] = (0.0, 0.0),
) -> RigidTransform:
    """Pose in the camera of a body that faces it from the working distance.

    Its y points up in the image; ``yaw_deg`` turns it about its own z after the tilts about x, y.
    """
    towards = Rotation.from_euler("x", 180, degrees=True)
    tilted = Rotation.from_euler("xy", tilt_deg, degrees=True)
    turned = Rotation.from_euler("z", yaw_deg, degrees=True)
    place = np.array([0.0, 0.0, WORKING_DISTANCE_M]) + shift_m
    return RigidTransform.from_components(place, towards * tilted * turned)


def render(
    camera: MonoTruth,
    bodies: Iterable[ConnectorBody],
    look: ConnectorLook | None = None,
    *,
    pixels: Pixels = "grey",
    seed: int = 0,
) -> ConnectorPicture:
    """One exposure with its truth; ``seed`` is that of the noise and of the light's direction.

    Raises ``ValueError`` when a body is seen from behind.
    """
    shown = tuple(bodies)
    chosen = ConnectorLook() if look is None else look
    (view,) = views_of(camera)
    rng = np.random.default_rng([seed, 17])
    clean = connector_channels(view, shown, chosen, pixels, seed)
    channels = [exposed(channel, chosen.sensor, rng) for channel in clean]
    connectors = {
        body.name: ConnectorTruth(body.camera_T_connector, contact_truths(view, body))
        for body in shown
        if isinstance(body, SceneConnector)
    }
    marks = {
        name: truth
        for body in shown
        if isinstance(body, SceneMarks)
        for name, truth in mark_truths(view, body).items()
    }
    return ConnectorPicture(put_together(channels, pixels), camera, connectors, marks)
