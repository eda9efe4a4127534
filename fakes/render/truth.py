"""Ground truth in pixels and metres, for tests and benchmarks."""

import numpy as np

from fakes.render.bodies.holes import circle, rim_depth
from fakes.render.optics.lens import Array, views
from fakes.render.optics.surface import to_pixels
from fakes.render.options import RenderOptions
from fakes.world.scene import ScenePlate, StereoTruth

_DEFAULT = RenderOptions()


def hole_centres_m(plate: ScenePlate, options: RenderOptions = _DEFAULT) -> dict[str, Array]:
    """Centre of the rim that carries the centre, in the left camera, by name."""
    return {
        hole.name: np.asarray(
            plate.camera_T_part.apply([*hole.position_m, -rim_depth(hole, options)])
        )
        for hole in plate.holes
    }


def project_hole_centres(
    stereo: StereoTruth, plate: ScenePlate, options: RenderOptions = _DEFAULT
) -> dict[str, tuple[Array, Array]]:
    """Left and right pixel onto which each circle's *centre* projects, by name."""
    left, right = views(stereo)
    result = {}
    for hole in plate.holes:
        point = np.array([[*hole.position_m, -rim_depth(hole, options)]])
        pose = plate.camera_T_part
        result[hole.name] = (to_pixels(left, pose, point)[0], to_pixels(right, pose, point)[0])
    return result


def project_rims(
    stereo: StereoTruth,
    plate: ScenePlate,
    options: RenderOptions = _DEFAULT,
    *,
    points: int = 360,
) -> dict[str, tuple[Array, Array]]:
    """Left and right outline, shape (points, 2), of the rim that carries the centre, by name."""
    left, right = views(stereo)
    result = {}
    for hole in plate.holes:
        rim = circle(hole, hole.diameter_m, rim_depth(hole, options), points)
        pose = plate.camera_T_part
        result[hole.name] = (to_pixels(left, pose, rim), to_pixels(right, pose, rim))
    return result
