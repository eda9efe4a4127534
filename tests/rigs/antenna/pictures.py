"""Rendered connectors with the files that belong to them, drawn from a seed."""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.connector.connector import Connector, read_connector
from cellctl.processes.antenna_module.connector.marks import Marks, read_marks
from cellctl.processes.antenna_module.vision.matching import rigid
from cellctl.processes.antenna_module.vision.pixels import MeasuredPixels, measured_pixels
from cellctl.processes.antenna_module.vision.plane import (
    ExpectedPlace,
    PlaneCalibration,
    facing_camera,
)
from cellctl.vision.camera.single_camera import SingleCamera
from cellctl.vision.camera.stereo_head import CameraModel
from fakes.render.connectors import api
from fakes.render.options import RenderOptions
from fakes.world.connector.drawing import ContactKind
from fakes.world.connector.scene import Tip
from fakes.world.scene import MonoTruth

FOLDER = Path("config/connectors")
_DISTANCE_M = api.WORKING_DISTANCE_M


@dataclass(frozen=True, slots=True)
class Conditions:
    """What a row of the table varies."""

    name: str = "micro-d-15"
    kind: ContactKind = "pins"
    um_per_px: tuple[float, float] = (20.0, 35.0)
    noise_grey: float = 2.0
    blur_px: tuple[float, float] = (0.8, 1.2)
    one_sided: float = 0.3
    off_axis_m: float = 2e-3
    wall_light: float = 0.0
    tip: Tip = "chamfer"
    pixels: Literal["grey", "rgb", "bayer"] = "rgb"
    missing: int = 0
    """Contacts that are missing, at random."""
    bent_m: float = 0.0
    """How far one contact is bent, in any direction."""
    blocked: int = 0
    """Holes with something in them, at random."""
    dirt: int = 0
    """Specks on contacts and insulator."""
    arc_deg: float | None = None
    """Length of the lit arc of the ring; None for all of it."""
    height_sigma_m: float = 0.0
    """Stated for the plane, which is exact; it counts for what is refused as of another size."""
    turn_deg: float = 0.0
    marks: bool = False
    size_px: tuple[int, int] | None = None


CLEAN = Conditions()
POOR = Conditions(noise_grey=4.0, blur_px=(2.0, 2.0), um_per_px=(25.0, 25.0))
HOLES = Conditions(kind="holes", height_sigma_m=0.2e-3)
"""The height as uncertain as a recipe states it."""


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """One image and everything that is needed to measure and to judge it."""

    pixels: MeasuredPixels
    camera: SingleCamera
    plane: PlaneCalibration
    connector: Connector
    marks: Marks | None
    truth: RigidTransform
    """camera_T_connector of the best fit of the good contacts as they are: what mates."""
    faulty: tuple[str, ...]
    """Contacts that are missing, bent or blocked."""


@cache
def drawing(name: str, kind: str) -> Connector:
    """A shipped drawing."""
    return read_connector(FOLDER / f"{name}-{kind}.toml")


def exact_model(camera: MonoTruth) -> SingleCamera:
    """A rendered camera as a calibration without error has it."""
    lens = camera.lens
    matrix = np.diag([*lens.focal_px, 1.0])
    matrix[:2, 2] = lens.centre_px
    return SingleCamera(camera.image_size_px, CameraModel(matrix, np.array(lens.distortion)))


def trial(seed: int, conditions: Conditions) -> Trial:
    """The image of a seed, with its truth."""
    rng = np.random.default_rng([seed, 20_131])
    connector = drawing(conditions.name, conditions.kind)
    um_per_px = float(rng.uniform(*conditions.um_per_px))
    size_px = conditions.size_px or _size_px(connector, um_per_px, conditions)
    lens_blur = float(rng.uniform(*conditions.blur_px))
    camera = api.nominal_camera(um_per_px=um_per_px, size_px=size_px, blur_px=lens_blur)
    single = exact_model(camera)
    direction, radius = rng.uniform(0.0, 2.0 * np.pi), np.sqrt(rng.uniform())
    offset = conditions.off_axis_m * radius * np.array([np.cos(direction), np.sin(direction)])
    yaw_deg = float(rng.uniform(-1.0, 1.0))
    pose = api.facing(
        shift_m=(float(offset[0]), float(offset[1]), 0.0), yaw_deg=yaw_deg + conditions.turn_deg
    )
    names = [str(name) for name in rng.permutation(connector.contacts)]
    missing = tuple(names[: conditions.missing])
    blocked = tuple(names[: conditions.blocked])
    bend = rng.uniform(0.0, 2.0 * np.pi)
    bent = (
        {
            names[-1]: (
                conditions.bent_m * float(np.cos(bend)),
                conditions.bent_m * float(np.sin(bend)),
            )
        }
        if conditions.bent_m
        else {}
    )
    body = api.connector_as_made(
        conditions.name,
        conditions.kind,
        seed=seed,
        camera_T_connector=pose,
        missing=missing,
        bent_m=bent,
        blocked=blocked,
        dirt=conditions.dirt,
        tip=conditions.tip,
    )
    marks_pose = api.facing(
        shift_m=(
            float(offset[0] + rng.uniform(-5e-4, 5e-4)),
            float(offset[1] + rng.uniform(-5e-4, 5e-4)),
            0.0,
        ),
        yaw_deg=float(rng.uniform(-1.0, 1.0)),
    )
    look = api.ConnectorLook(
        lamps=api.Lamps(
            one_sided=conditions.one_sided,
            azimuth_rad=float(rng.uniform(0.0, 2.0 * np.pi)),
            arc_deg=conditions.arc_deg,
        ),
        wall_light=conditions.wall_light,
        sensor=replace(_sensor(), noise_grey=conditions.noise_grey),
    )
    bodies = (body, api.gripper_marks(marks_pose)) if conditions.marks else (body,)
    shown = api.render(camera, bodies, look, pixels=conditions.pixels, seed=seed)
    # The renderer gives red, green, blue; files are blue, green, red.
    image = shown.image[:, :, ::-1] if conditions.pixels == "rgb" else shown.image
    faulty = tuple(sorted({*missing, *bent, *blocked}))
    contacts = shown.connectors[conditions.name].contacts
    places = np.array([contacts[name].connector_m[:2] for name in connector.contacts])
    plane = RigidTransform.from_translation([0.0, 0.0, _DISTANCE_M])
    trained = api.facing(yaw_deg=0.0)
    return Trial(
        pixels=measured_pixels(
            np.ascontiguousarray(image), "bayer" if conditions.pixels == "bayer" else "auto"
        ),
        camera=single,
        plane=PlaneCalibration(
            single.id,
            facing_camera(plane),
            conditions.height_sigma_m,
            0.0,  # the plane is parallel to the image
            ExpectedPlace(trained, 3e-3, float(np.radians(3.0))),
        ),
        connector=connector,
        marks=read_marks(FOLDER / "gripper.toml") if conditions.marks else None,
        truth=_best_fit(pose, connector, places, faulty),
        faulty=faulty,
    )


def _best_fit(
    pose: RigidTransform, connector: Connector, places_m: Array, faulty: tuple[str, ...]
) -> RigidTransform:
    good = np.array([name not in faulty for name in connector.contacts])
    yaw, shift = rigid(connector.positions_m[good], places_m[good])
    turn = RigidTransform.from_rotation(Rotation.from_rotvec([0.0, 0.0, yaw]))
    return pose * (RigidTransform.from_translation([*shift, 0.0]) * turn)


def _sensor() -> RenderOptions:
    return api.ConnectorLook().sensor


def _size_px(connector: Connector, um_per_px: float, conditions: Conditions) -> tuple[int, int]:
    """The connector with its shell and the most that it may be off, not the whole sensor."""
    if conditions.marks:
        return round(0.058 / um_per_px * 1e6), round(0.027 / um_per_px * 1e6)
    sides_m = np.array(connector.outline_m) + 2.0 * conditions.off_axis_m + 3e-3
    width, height = (round(float(side) / um_per_px * 1e6) for side in sides_m)
    return width, height
