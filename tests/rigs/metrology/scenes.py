"""Rendered parts with known truth, seen by one or two heads, for the metrology benchmark."""

from collections.abc import Iterator
from typing import Literal

import numpy as np

from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.stereo_camera import Image
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead
from cellctl.vision.features.hole import Hole
from fakes.render import api
from fakes.world.scene import LensTruth, ScenePlate, StereoTruth
from tests.rigs.metrology.views import HeadView, PartView

HEADS: tuple[Literal[1, 2], ...] = (1, 2)
HEAD_HOLES = (("P1", "P2", "P3"), ("P4", "P5", "P6"))


def parts(
    kind: Literal["frame", "deck"],
    options: api.RenderOptions,
    plates: int,
    exposures: int,
    *,
    seed: int = 0,
) -> Iterator[PartView]:
    """Plates at random poses within the cell's tolerance, each exposed several times."""
    for number in range(plates):
        rng = np.random.default_rng([seed, number])
        blur_px = float(rng.uniform(0.95, 1.05))
        stereo = api.nominal_head(blur_px=blur_px)
        tilt_x_deg, tilt_y_deg, tilt_z_deg = rng.uniform([-2.0, -2.0, -3.0], [2.0, 2.0, 3.0])
        x_m, y_m, z_m = rng.uniform(-6e-3, 6e-3, 3)
        plates_seen = [
            api.nominal_plate(
                kind,
                head=head,
                tilt_deg=(tilt_x_deg, tilt_y_deg, tilt_z_deg),
                shift_m=(x_m, y_m, z_m),
                seed=number + 1,
            )
            for head in HEADS
        ]
        clean = [
            api.clean_pair(stereo, [plate], options, light_seed=2 * number + head)
            for head, plate in enumerate(plates_seen)
        ]
        for _ in range(exposures):
            first, second = (
                _view(stereo, plate, api.expose(images, options, rng), names, blur_px)
                for plate, images, names in zip(plates_seen, clean, HEAD_HOLES, strict=True)
            )
            transfer = first.camera_T_part * second.camera_T_part.inv()
            yield PartView((first, second), UncertainPose.exact(transfer))


def stereo_head(truth: StereoTruth) -> StereoHead:
    """A perfectly calibrated head."""
    rotation = truth.right_T_left.rotation.as_matrix()
    translation_m = np.asarray(truth.right_T_left.translation)
    left, right = _camera(truth.left), _camera(truth.right)
    return StereoHead(truth.image_size_px, left, right, rotation, translation_m, 0.0)


def holes_of(plate: ScenePlate, names: tuple[str, ...]) -> tuple[Hole, ...]:
    """The named holes as a feature file would give them."""
    return tuple(
        Hole(
            hole.name,
            hole.kind,
            hole.diameter_m,
            np.array([*hole.position_m, 0.0]),
            hole.countersink_m,
        )
        for hole in plate.holes
        if hole.name in names
    )


def _view(
    stereo: StereoTruth,
    plate: ScenePlate,
    images: tuple[Image, Image],
    names: tuple[str, ...],
    blur_px: float,
) -> HeadView:
    centres = api.project_hole_centres(stereo, plate)
    points = api.hole_centres_m(plate)
    return HeadView(
        stereo_head(stereo),
        holes_of(plate, names),
        plate.camera_T_part,
        images,
        {name: centres[name] for name in names},
        {name: points[name] for name in names},
        blur_px,
    )


def _camera(lens: LensTruth) -> CameraModel:
    fx, fy = lens.focal_px
    cx, cy = lens.centre_px
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return CameraModel(matrix, np.array(lens.distortion))
