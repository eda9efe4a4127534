"""Three views of a model: from above, from the front and from the side."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from cellctl.calibration.drawing import as_png
from cellctl.geometry.pose import Array
from cellctl.planning.pictures.frusta import Frustum
from cellctl.planning.pictures.paths import FlangePath
from cellctl.planning.pictures.poses import DrawnBody, drawn_bodies
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.plot_style import ACCENT, GOOD, GRID, INK, MUTED, SECOND, style

_VIEWS = (
    ("from above", 0, 1, 2, 1),
    ("from the front", 0, 2, 1, -1),
    ("from the side", 1, 2, 0, 1),
)
"""Title, the axes that go right and up, the axis of sight, and which end of it is near."""
_ROOM_M = 0.2


@style()
def three_views(scene: CellScene, views: Sequence[Frustum], paths: Sequence[FlangePath]) -> bytes:
    """A PNG: fixtures grey, arms blue, stand-ins of arms orange, other taught poses as ghosts.

    What heads see is drawn in green lines, the ways of the flanges in dark ones.
    """
    figure = Figure(figsize=(13.0, 4.6), layout="constrained")
    bodies = list(drawn_bodies(scene))
    # The frame of a picture is that of what moves: a floor or a fence may be many times larger.
    moved = [body.mesh.bounds for body in bodies if body.solid.arm is not None]
    lower, upper = np.min(moved, axis=(0, 1)) - _ROOM_M, np.max(moved, axis=(0, 1)) + _ROOM_M
    for axes, view in zip(figure.subplots(1, 3), _VIEWS, strict=True):
        _draw(axes, bodies, view)
        _, right, up, *_ = view
        for one in views:
            edges: Array = one.edges_m[:, :, [right, up]]
            axes.add_collection(LineCollection(list(edges), colors=[GOOD], linewidths=0.6))
        for path in paths:
            axes.plot(*path.points_m[:, [right, up]].T, color=INK, linewidth=0.9, linestyle="-")
        axes.set_xlim(lower[right], upper[right])
        axes.set_ylim(lower[up], upper[up])
        axes.set_aspect("equal")
    return as_png(figure)


def _draw(axes: Axes, bodies: list[DrawnBody], view: tuple[str, int, int, int, int]) -> None:
    title, right, up, sight, near = view
    # The nearest last, over what it hides.
    for body in sorted(bodies, key=lambda one: near * float(one.mesh.centroid[sight])):
        corners: Array = np.asarray(body.mesh.triangles)[:, :, [right, up]]
        alpha = 0.03 if body.ghost else 0.25
        axes.add_collection(
            PolyCollection(list(corners), facecolor=_colour(body), edgecolor="none", alpha=alpha)
        )
    axes.set_title(title)
    axes.set_xlabel(f"{'xyz'[right]} in m")
    axes.set_ylabel(f"{'xyz'[up]} in m")
    axes.tick_params(colors=MUTED)


def _colour(body: DrawnBody) -> str:
    if body.solid.arm is None:
        return GRID
    return SECOND if body.solid.stand_in else ACCENT
