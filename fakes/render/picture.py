"""Draws the clean picture that each camera has of a scene."""

from functools import partial

import numpy as np

from fakes.render.bodies.boards import draw_chessboard, draw_target_board
from fakes.render.bodies.plate import draw_plate
from fakes.render.model import SceneCharucoBoard, SceneObject, pose_of
from fakes.render.optics.canvas import Image, Patch
from fakes.render.optics.lens import View, views_of
from fakes.render.optics.light import light_direction, light_field
from fakes.render.optics.sensor import blurred
from fakes.render.optics.surface import is_seen
from fakes.render.options import RenderOptions
from fakes.world.scene import (
    MonoTruth,
    SceneChessboard,
    ScenePlate,
    SceneTargetBoard,
    StereoTruth,
)


def clean_pictures(
    optics: StereoTruth | MonoTruth,
    objects: tuple[SceneObject, ...],
    options: RenderOptions,
    light_seed: int,
) -> tuple[Image, ...]:
    """Left and right picture of a head, or the one of a single camera.

    In grey levels, without noise, not rounded and not clipped.
    """
    return tuple(clean_picture(view, objects, options, light_seed) for view in views_of(optics))


def clean_picture(
    view: View, objects: tuple[SceneObject, ...], options: RenderOptions, light_seed: int
) -> Image:
    """Picture of one camera, farther objects drawn first; faces turned away are left out.

    The nearest object is the one that is measured: its edges are blurred in fine cells.
    """
    width, height = view.size_px
    image = np.full((height, width), options.floor_grey, dtype=np.float32)
    seen = [item for item in objects if is_seen(view, pose_of(item))]
    if not seen:
        return image
    # Painter's algorithm: nearer objects are laid over farther ones.
    seen.sort(key=lambda item: -float(pose_of(item).translation[2]))
    azimuth = light_direction(light_seed)
    draw = partial(_draw, view, image, seen=seen, options=options, light_azimuth=azimuth)
    for item in seen[:-1]:
        for patch in draw(item, blur_px=0.0):
            patch.lay_over(image)
    blur_px = view.lens.blur_px
    measured = draw(seen[-1], blur_px=blur_px)
    light = light_field(view, pose_of(seen[-1]), light_seed, options)
    # The light of the measured object is laid over everything behind it too, which is only looked
    # at.
    image *= light
    # The blur comes before the measured details, which bring their own from finer cells: blurred
    # once more, they would be too soft.
    image = blurred(image, blur_px)
    for patch in measured:
        patch.lay_over(image, light)
    return image


def _draw(
    view: View,
    image: Image,
    item: SceneObject,
    *,
    seen: list[SceneObject],
    options: RenderOptions,
    light_azimuth: float,
    blur_px: float,
) -> list[Patch]:
    """Lay one object over ``image``; what must be exact is returned, blurred by ``blur_px``."""
    match item:
        case ScenePlate():
            plates = [other for other in seen if isinstance(other, ScenePlate)]
            place = plates.index(item)
            return draw_plate(
                view,
                image,
                item,
                options,
                light_azimuth=light_azimuth,
                blur_px=blur_px,
                below=plates[place - 1] if place > 0 else None,
                above=plates[place + 1] if place + 1 < len(plates) else None,
            )
        case SceneTargetBoard():
            return draw_target_board(view, image, item, options, blur_px)
        case SceneChessboard() | SceneCharucoBoard():
            return draw_chessboard(view, image, item, options, blur_px)
