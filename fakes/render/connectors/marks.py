"""Marks on the fingers of the gripper: white discs on dark plates."""

import numpy as np

from fakes.render.connectors.canvas import Canvas, ColouredPatch
from fakes.render.connectors.look import ConnectorLook
from fakes.render.connectors.outline import Outline
from fakes.render.connectors.shading import PAPER, Shading
from fakes.render.optics.canvas import Patch, margin_px
from fakes.render.optics.coverage import coverage
from fakes.render.optics.lattice import window_around
from fakes.render.optics.lens import View
from fakes.render.optics.surface import surface_map, to_pixels
from fakes.world.connector.scene import BLACK, WHITE, SceneMark, SceneMarks


def draw_plates(canvas: Canvas, view: View, marks: SceneMarks, look: ConnectorLook) -> None:
    """The plates that carry the marks."""
    pose = marks.camera_T_marks
    level = look.exposure * Shading.of(look.lamps, PAPER, pose).flat()
    for x, y, width, height in marks.plates_m:
        outline = Outline.rectangle(width, height, (x, y))
        window = outline.window(view, pose, (0.0,))
        if window is not None:
            canvas.paint(window, outline.cover(view, pose, window, 0.0), level, BLACK)


def mark_patch(
    view: View, marks: SceneMarks, mark: SceneMark, look: ConnectorLook
) -> ColouredPatch | None:
    """One disc, exact to a thousandth of a pixel; None outside of the image."""
    pose, radius_m = marks.camera_T_marks, mark.diameter_m / 2
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    x0, y0 = mark.position_m
    rim = np.column_stack(
        [x0 + radius_m * np.cos(angle), y0 + radius_m * np.sin(angle), np.zeros(32)]
    )
    blur_px = view.lens.blur_px
    pixels = to_pixels(view, pose, rim)
    window = window_around(view, pixels, margin_px(blur_px), look.sensor.sub_samples)
    if window is None:
        return None
    x, y = surface_map(view, pose, window)
    outside = coverage(np.hypot(x - x0, y - y0) - radius_m)
    level = look.exposure * Shading.of(look.lamps, PAPER, pose).flat()
    return ColouredPatch(Patch.of_one_grey(window, outside, level, blur_px), WHITE)
