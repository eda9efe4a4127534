"""What is known beside the devices during a run: told here, kept by the recording of the run."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from cellctl.clock import now_s


@dataclass(frozen=True, slots=True)
class RunNote:
    """What one topic of the recording says from one moment on."""

    topic: str
    time_s: float
    """Monotonic time in seconds."""
    values: Mapping[str, Any]
    """Plain data with units in the names."""


class RunNotes:
    """Passes each note on to all listeners. Belongs to one event loop; ``tell`` never waits."""

    def __init__(self) -> None:
        self.listeners: list[Callable[[RunNote], None]] = []
        self._newest: dict[str, RunNote] = {}

    @property
    def newest(self) -> tuple[RunNote, ...]:
        """The last note of each topic. A recording begins with them: they hold already."""
        return tuple(self._newest.values())

    def tell(self, topic: str, values: Mapping[str, Any]) -> None:
        """Set the values of a topic; the listeners hear of it only when a value has changed."""
        before = self._newest.get(topic)
        if before is not None and before.values == values:
            return
        note = self._newest[topic] = RunNote(topic, now_s(), values)
        for listener in self.listeners:
            listener(note)
