"""Reads a scenario from its file, and makes a world of it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.written import read_written
from fakes.scenes.registry import scene_class
from fakes.world.world import World


def load(path: Path, imperfections: Mapping[str, float] | None = None) -> Scenario:
    """Read a scenario file with the model of the scene that it names.

    ``imperfections`` are scales by name that replace those of the file. Raises ``OSError``,
    ``tomllib.TOMLDecodeError``, ``pydantic.ValidationError``,
    ``fakes.imperfections.UnknownImperfection`` or ``fakes.scenes.registry.UnknownScene``.
    """
    written = read_written(path, imperfections or {})
    return scene_class(str(written.get("scene", ""))).scenario_model.model_validate(written)


def open_world(scenario: Scenario, seed: int) -> World[Any]:
    """The world of a scenario: its devices by the hardware seed, all else by ``seed``."""
    return scene_class(scenario.scene)(scenario, seed)
