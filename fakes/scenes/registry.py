"""Scenes by name: entry points, loaded only when a scenario file names them."""

from importlib.metadata import entry_points
from typing import Any

from fakes.world.world import World

GROUP = "fakes.scene"


class UnknownScene(LookupError):
    """No installed package brings a scene of this name."""


def scene_class(name: str) -> type[World[Any]]:
    """The class of a scene; raises ``UnknownScene``, which names the scenes that are known."""
    for point in entry_points(group=GROUP, name=name):
        found = point.load()
        if isinstance(found, type) and issubclass(found, World):
            return found
        raise UnknownScene(f"scene {name!r}: {point.value} is not a World")
    known = ", ".join(sorted(point.name for point in entry_points(group=GROUP))) or "none"
    raise UnknownScene(f"there is no scene {name!r}; known scenes: {known}")
