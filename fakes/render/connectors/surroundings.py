"""Housing or panel, shell and insulator: what surrounds the contacts and is only looked at."""

import numpy as np

from fakes.render.bodies.texture import brushed_tile, sample
from fakes.render.connectors.canvas import Canvas
from fakes.render.connectors.look import ConnectorLook
from fakes.render.connectors.outline import Outline
from fakes.render.connectors.shading import METAL, PLASTIC, Shading
from fakes.render.optics.lens import View
from fakes.render.optics.surface import surface_map
from fakes.world.connector.scene import BARE_METAL, SceneConnector

_BASE_M = 1.0e-3
"""Height from the housing to the ground of a plug's insulator, or to a socket's block."""
_TEXTURE_ZOOM = 8.0
"""The tile is that of a milled deck; a connector's housing is worked more finely."""
_SHELL_HEIGHTS = 4
_SHELL_WALL = 0.45
"""Light on the walls of the shell, of that on its edge."""


def draw_surroundings(
    canvas: Canvas, view: View, connector: SceneConnector, look: ConnectorLook
) -> None:
    """Draws what is farther away first."""
    drawing = connector.drawing
    long_m, short_m, height_m = drawing.insulator_m
    d_shape = Outline.d_shape(long_m, short_m)
    if connector.kind == "pins":
        ground_m, edge_m = -drawing.pin_length_m, drawing.shell_over_tips_m
        housing_m = ground_m - _BASE_M
    else:
        # The block of a socket goes into the plug's shell, so its own shell ends at its face.
        ground_m, edge_m = 0.0, 0.0
        housing_m = -height_m - _BASE_M
    _housing(canvas, view, connector, look, housing_m)
    _shell(canvas, view, connector, look, (housing_m, edge_m))
    pose = connector.camera_T_connector
    window = d_shape.window(view, pose, (ground_m, edge_m))
    if window is None:
        return
    shading = Shading.of(look.lamps, PLASTIC, pose)
    opening = d_shape.cover(view, pose, window, edge_m)
    ground = opening * d_shape.cover(view, pose, window, ground_m)
    metal = Shading.of(look.lamps, METAL, pose).flat()
    canvas.paint(window, opening, look.exposure * 0.3 * _SHELL_WALL * metal, BARE_METAL)
    canvas.paint(window, ground, look.exposure * shading.flat(), drawing.insulator_colour)


def _housing(
    canvas: Canvas, view: View, connector: SceneConnector, look: ConnectorLook, z_m: float
) -> None:
    pose = connector.camera_T_connector
    outline = Outline.rectangle(*connector.housing_m)
    window = outline.window(view, pose, (z_m,))
    if window is None:
        return
    x, y = surface_map(view, pose, window, z_m=z_m)
    brushed = sample(brushed_tile(connector.seed), _TEXTURE_ZOOM * x, _TEXTURE_ZOOM * y)
    relative = 1 + look.sensor.texture_grey / look.sensor.plate_grey * brushed
    shade = look.exposure * Shading.of(look.lamps, METAL, pose).flat() * relative
    canvas.paint(window, outline.cover(view, pose, window, z_m), shade, BARE_METAL)


def _shell(
    canvas: Canvas,
    view: View,
    connector: SceneConnector,
    look: ConnectorLook,
    heights_m: tuple[float, float],
) -> None:
    """The outer wall as the union of slices, then the edge over it."""
    pose, thick_m = connector.camera_T_connector, connector.drawing.shell_m
    d_shape = Outline.d_shape(*connector.drawing.insulator_m[:2])
    window = d_shape.window(view, pose, heights_m, thick_m)
    if window is None:
        return
    slices = [
        d_shape.cover(view, pose, window, z_m, thick_m)
        for z_m in np.linspace(*heights_m, _SHELL_HEIGHTS)
    ]
    level = look.exposure * Shading.of(look.lamps, METAL, pose).flat()
    canvas.paint(window, np.maximum.reduce(slices), _SHELL_WALL * level, BARE_METAL)
    canvas.paint(window, slices[-1], level, BARE_METAL)
