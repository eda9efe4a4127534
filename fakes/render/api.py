"""Rendered stereo pairs with exact sub-pixel geometry, for tests, benchmarks and the fake heads.

    import numpy as np
    from fakes.render import api

    stereo = api.nominal_head(blur_px=1.0)                  # StereoTruth: lenses, right_T_left
    deck = api.nominal_plate("deck", head=1, tilt_deg=(1, -2, 0), shift_m=(1e-3, 0, 0))
    left, right = api.render_pair(stereo, [deck], api.RenderOptions(), np.random.default_rng(5))
    truth = api.project_hole_centres(stereo, deck)          # {"P1": (left_px, right_px), …}
    points = api.hole_centres_m(deck)                       # {"P1": xyz in the left camera, …}
    outline = api.project_rims(stereo, deck)["P1"][0]       # (360, 2) px, left

- Objects: ``ScenePlate``, ``SceneTargetBoard``, ``SceneChessboard`` (of ``fakes.world.scene``) and
  ``SceneCharucoBoard``, in any order; nearer ones hide farther ones. Poses are in the left camera;
  the z of an object points out of its visible face, towards the camera. Build them yourself or
  with ``nominal_plate``, ``nominal_target_board``, ``nominal_chessboard``, ``facing_pose``.
- Pixel centres lie at integers. Hole truth is the projection of the circle's centre, not the
  centre of its ellipse.
- ``RenderOptions()`` looks like a machined plate; ``RenderOptions.clean(noise_grey=2.0)`` gives
  even light, dark holes without visible walls and no texture; any field can be set by name:
  ``light_gradient_per_m``, ``wall_grey``, ``texture_grey``, ``scratches_per_m2``, …
- Blur and gain belong to the lens: ``nominal_head(blur_px=…)`` or ``LensTruth.blur_px``.
- Several frames of an unmoved scene: ``clean = clean_pair(…)`` once (float32, no noise, not
  rounded), then ``expose(clean, options, rng)`` for each; only the noise differs.
- ``render_scene(scene, options)`` takes a whole ``CameraScene`` of the world with its seeds.
- What is measured (holes, discs, prints of the nearest object) is exact: edges within 0.001 px of
  the analytic projection, blur from 4 × 4 cells a pixel or in closed form. Outlines of plates and
  things behind the nearest object are only good to look at.
- A head with a small ``image_size_px`` and a shifted ``centre_px`` renders a cut-out in 0.02 s.
- Cost per camera on one core: about 0.25 s for a plate or board, 0.05 s for another exposure.
"""

from collections.abc import Sequence

import numpy as np

from fakes.render.model import SceneCharucoBoard, SceneObject, plain_bodies
from fakes.render.nominal import (
    facing_pose,
    nominal_chessboard,
    nominal_head,
    nominal_holes,
    nominal_plate,
    nominal_target_board,
)
from fakes.render.optics.canvas import Image
from fakes.render.optics.sensor import Grey, exposed
from fakes.render.options import RenderOptions
from fakes.render.picture import clean_pictures
from fakes.render.truth import hole_centres_m, project_hole_centres, project_rims
from fakes.world.scene import CameraScene, StereoTruth

__all__ = [
    "RenderOptions",
    "SceneCharucoBoard",
    "clean_pair",
    "expose",
    "facing_pose",
    "hole_centres_m",
    "nominal_chessboard",
    "nominal_head",
    "nominal_holes",
    "nominal_plate",
    "nominal_target_board",
    "project_hole_centres",
    "project_rims",
    "render_pair",
    "render_scene",
]

_DEFAULT = RenderOptions()


def render_pair(
    stereo: StereoTruth,
    objects: Sequence[SceneObject],
    options: RenderOptions = _DEFAULT,
    rng: np.random.Generator | None = None,
    *,
    light_seed: int = 0,
) -> tuple[Grey, Grey]:
    """Left and right 8-bit image, shape (height, width)."""
    clean = clean_pair(stereo, objects, options, light_seed=light_seed)
    return expose(clean, options, rng or np.random.default_rng(0))


def clean_pair(
    stereo: StereoTruth,
    objects: Sequence[SceneObject],
    options: RenderOptions = _DEFAULT,
    *,
    light_seed: int = 0,
) -> tuple[Image, Image]:
    """Left and right picture in grey levels, float32, without noise or rounding."""
    left, right = clean_pictures(stereo, tuple(objects), options, light_seed)
    return left, right


def expose(
    clean: tuple[Image, Image], options: RenderOptions, rng: np.random.Generator
) -> tuple[Grey, Grey]:
    """One exposure of an unmoved scene: new noise, 8 bits."""
    # Two draws of one generator: the noise of both cameras is independent, and still repeatable.
    left, right = clean
    return exposed(left, options, rng), exposed(right, options, rng)


def render_scene(scene: CameraScene, options: RenderOptions = _DEFAULT) -> tuple[Grey, ...]:
    """One exposure of a scene of the world, an image per lens; its noise seed decides the noise."""
    clean = clean_pictures(scene.optics, plain_bodies(scene), options, scene.light_seed)
    rng = np.random.default_rng(scene.noise_seed)
    return tuple(exposed(picture, options, rng) for picture in clean)
