"""From a scene to the clean picture of each camera."""

import numpy as np

from fakes.render.boards import draw_chessboard, draw_target_board
from fakes.render.canvas import Image
from fakes.render.lens import View, views
from fakes.render.light import light_direction, light_field
from fakes.render.model import SceneCharucoBoard, SceneObject, pose_of
from fakes.render.options import RenderOptions
from fakes.render.plate import draw_plate
from fakes.render.sensor import blurred
from fakes.render.surface import is_seen
from fakes.world.scene import (
    CameraScene,
    SceneChessboard,
    ScenePlate,
    SceneTargetBoard,
    StereoTruth,
)


def clean_pair(
    stereo: StereoTruth,
    objects: tuple[SceneObject, ...],
    options: RenderOptions,
    light_seed: int,
) -> tuple[Image, Image]:
    """Pictures without noise, in grey levels, not rounded and not clipped."""
    left, right = views(stereo)
    return (
        clean_picture(left, objects, options, light_seed),
        clean_picture(right, objects, options, light_seed),
    )


def clean_picture(
    view: View, objects: tuple[SceneObject, ...], options: RenderOptions, light_seed: int
) -> Image:
    """Picture of one camera, farther objects drawn first; faces turned away are left out."""
    width, height = view.size_px
    image = np.full((height, width), options.floor_grey, dtype=np.float32)
    seen = [item for item in objects if is_seen(view, pose_of(item))]
    seen.sort(key=lambda item: -float(pose_of(item).translation[2]))
    azimuth = light_direction(light_seed)
    plates = [item for item in seen if isinstance(item, ScenePlate)]
    for item in seen:
        match item:
            case ScenePlate():
                place = plates.index(item)
                below = plates[place - 1] if place > 0 else None
                above = plates[place + 1] if place + 1 < len(plates) else None
                draw_plate(
                    view, image, item, options, light_azimuth=azimuth, below=below, above=above
                )
            case SceneTargetBoard():
                draw_target_board(view, image, item, options)
            case SceneChessboard() | SceneCharucoBoard():
                draw_chessboard(view, image, item, options)
    if seen:
        image *= light_field(view, pose_of(seen[-1]), light_seed, options)
    return blurred(image, view.lens.blur_px)


def scene_objects(scene: CameraScene) -> tuple[SceneObject, ...]:
    """What is there to be seen."""
    candidates = (scene.frame, scene.deck, scene.target_board, scene.chessboard)
    return tuple(item for item in candidates if item is not None)
