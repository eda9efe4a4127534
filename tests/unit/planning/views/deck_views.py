"""The measurement of the shipped deck cell, for the tests of planning viewpoints."""

from dataclasses import replace
from typing import Any

from cellctl.config.stated.views import StatedMeasurement
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.views.plan_viewpoints import stated_measurements
from tests.unit.planning.deck_cell import deck_scene

SCENE = deck_scene()


def measurement() -> StatedMeasurement:
    (found,) = stated_measurements(SCENE)
    return found


def with_limits(**changed: Any) -> CellScene:
    """The scene with other limits of both heads."""
    heads = {name: replace(limits, **changed) for name, limits in SCENE.heads.items()}
    return replace(SCENE, heads=heads)
