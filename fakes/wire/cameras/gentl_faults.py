"""Faults of a camera or head behind the fake GenTL producer: those of the frame servers, by their
names, as a GigE camera has them, and those that only a producer has."""

from collections.abc import Callable, Mapping
from typing import Final

from fakes.gentl.cameras import Fault
from fakes.gentl.exposures import Outcome
from fakes.render.image_faults import PICTURE_FAULTS, SCENE_FAULTS
from fakes.wire.named_faults import NamedFaults

UNANSWERED: Final[dict[str, str]] = {
    "silent": "no image comes",
    "half_open": "no image comes",
    "camera_fault": "no image comes",
}
SPOILED: Final[dict[str, Outcome]] = {
    "hang_up": Outcome.LOST,
    "truncated": Outcome.INCOMPLETE,
    "corrupt_payload": Outcome.INCOMPLETE,
    "corrupt_header": Outcome.INCOMPLETE,
    "frozen": Outcome.STALE,
    "wrong_id": Outcome.STALE,
}
"""A packet with a wrong sum never comes out of the network card, so it is missing. There is no
request that an image could name: what is not of this one is an old one."""
LATE: Final[dict[str, str]] = {
    "late": "the image comes so many seconds late (value)",
    "dribbled": "it comes in packets of so many bytes (value), 2 ms between them",
}
OF_THE_PRODUCER: Final[tuple[Fault, ...]] = ("busy", "lost", "hang", "crash")
"""Faults that last until they are cleared; a crash ends one process."""
_PACKET_S: Final = 0.002


class GentlFaults(NamedFaults):
    """Faults of all cameras of a device; one of them acts on an exposure of the whole device."""

    NAMES: Final = (
        *UNANSWERED,
        *SPOILED,
        *LATE,
        "wrong_size",
        *OF_THE_PRODUCER,
        *SCENE_FAULTS,
        *PICTURE_FAULTS,
    )

    def __init__(self, at_producer: Callable[[Fault, int], None]) -> None:
        """``at_producer`` switches a fault of the producer on (1) or off (0)."""
        super().__init__(self.NAMES)
        self._at_producer = at_producer

    def inject(self, name: str, value: float = 1.0, *, replies: int | None = None) -> None:
        """Switch a fault on, until ``clear`` or for the next ``replies`` exposures."""
        if name not in OF_THE_PRODUCER:
            super().inject(name, value, replies=replies)
            return
        if replies is not None:
            raise ValueError(f"{name} lasts until it is cleared, not for a number of exposures")
        if name == "busy":
            # A camera that another program has taken does not answer this one any more.
            self._at_producer("lost", 1)
            self._at_producer("lost", 0)
        self._switch(name, 1)

    def clear(self, name: str | None = None) -> None:
        """Switch one fault, or all of them, off."""
        super().clear(name)
        self._switch(name, 0)

    def _switch(self, name: str | None, amount: int) -> None:
        for fault in OF_THE_PRODUCER:
            if name in (None, fault):
                self._at_producer(fault, amount)


def outcome(faults: Mapping[str, float]) -> Outcome | None:
    """What becomes of an exposure with these faults; None for one of which no image comes."""
    if UNANSWERED.keys() & faults.keys():
        return None
    return next((SPOILED[name] for name in SPOILED if name in faults), Outcome.WHOLE)


def delay_s(faults: Mapping[str, float], size: int) -> float:
    """How long an image of ``size`` bytes is on its way beyond what is usual."""
    late_s = faults.get("late", 0.0)
    if "dribbled" in faults:
        late_s += size / max(faults["dribbled"], 1.0) * _PACKET_S
    return late_s
