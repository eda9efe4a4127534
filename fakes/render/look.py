"""The appearance that the scenario file asks for, as the renderer's options."""

from typing import Final

from fakes.render.options import RenderOptions
from fakes.scenario_file.appearance import Rendering

_IMAGE_WIDTH_M: Final = 0.34
_IMAGE_AREA_M2: Final = 0.097
_GLOSS: Final = 0.1
"""Relative height of the soft highlight on a milled face under a ring light."""


def options_of(
    rendering: Rendering, *, glare: float = 0.0, tilt_shading: float = 0.0
) -> RenderOptions:
    """Options of the scenario's section ``[rendering]``, and of two of its imperfections."""
    plate, hole = rendering.plate_level, rendering.hole_level
    darkest, brightest = rendering.countersink_levels
    shot_variance = plate / rendering.electrons_per_level
    variance = rendering.read_noise_levels**2 + shot_variance
    return RenderOptions(
        plate_grey=plate,
        floor_grey=rendering.background_level,
        dark_grey=hole,
        wall_grey=hole + rendering.wall_visibility * (plate - hole),
        cone_grey=plate * (darkest + brightest) / 2,
        # The scenario gives the extremes, the renderer needs mean and relative variation.
        cone_contrast=(brightest - darkest) / (brightest + darkest),
        thread_grey=plate * rendering.thread_levels[1],
        thread_root_grey=plate * rendering.thread_levels[0],
        white_grey=rendering.board_bright_level,
        black_grey=rendering.board_dark_level,
        texture_grey=rendering.texture_levels,
        # The scenario counts what is seen in one image; a part is larger and is worn all over.
        scratches_per_m2=rendering.scratches / _IMAGE_AREA_M2,
        false_circles_per_m2=rendering.false_circles / _IMAGE_AREA_M2,
        light_gradient_per_m=rendering.light_gradient / _IMAGE_WIDTH_M,
        gloss=_GLOSS + glare,
        mirror=tilt_shading,
        noise_grey=variance**0.5,
        shot_share=shot_variance / variance,
        recessed_rims=rendering.recessed_rims,
    )
