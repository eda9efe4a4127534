"""Demonstrations by the name of their process: entry points, loaded only when asked for."""

from importlib.metadata import entry_points

from fakes.demo.demo import Demo

GROUP = "fakes.demo"


class UnknownProcess(LookupError):
    """Nobody demonstrates a process of this name."""


def demonstrated() -> list[str]:
    """Names of the processes that have a demonstration."""
    return sorted(point.name for point in entry_points(group=GROUP))


def find(process: str) -> Demo:
    """The demonstration of a process; raises ``UnknownProcess``, which names those that exist."""
    for point in entry_points(group=GROUP, name=process):
        found = point.load()
        if isinstance(found, type) and issubclass(found, Demo):
            return found()
        raise UnknownProcess(f"the demonstration of {process!r}, {point.value}, is not a Demo")
    known = ", ".join(demonstrated()) or "none"
    raise UnknownProcess(f"there is no demonstration of {process!r}; there are: {known}")
