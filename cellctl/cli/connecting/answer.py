"""What one device has answered, or why not."""

import re
from collections.abc import Coroutine, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cellctl.cell.patience.calls import answer_within
from cellctl.errors import CellError
from cellctl.errors.internal import Unexpected
from cellctl.errors.local import OtherDevice

_OF_A_DAEMON = re.compile(r"[;,.] then Clear and Reset\.?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Answer:
    """One device, or another partner of the cell, by its path in the cell file."""

    path: str
    driver: str
    facts: Mapping[str, str] = field(default_factory=dict)
    """Words by name, for people."""
    serial_number: str = ""
    """Empty where the device has none, or did not answer."""
    differs: tuple[str, ...] = ()
    """What is not as the cell file or a calibration says."""
    notes: tuple[str, ...] = ()
    """What is worth a look before the first run, and no reason to call the cell wrong."""
    fault: CellError | None = None
    """Why there is no answer."""
    asked: bool = True
    """False for the line, which calls and cannot be asked."""

    @property
    def good(self) -> bool:
        """Whether it has answered, and is what is meant."""
        return self.fault is None and not self.differs

    @property
    def faults(self) -> tuple[CellError, ...]:
        """Its silence, and everything that differs, each with cause and remedy."""
        silence = () if self.fault is None else (self.fault,)
        return (*silence, *(OtherDevice(f"{self.path}: {text}") for text in self.differs))

    def as_json(self) -> dict[str, Any]:
        """The answer in a form for programs."""
        return {
            "path": self.path,
            "driver": self.driver,
            "answered": self.asked and self.fault is None,
            "good": self.good,
            "serial_number": self.serial_number,
            "facts": dict(self.facts),
            "notes": list(self.notes),
            "faults": [fault_as_json(fault) for fault in self.faults],
        }


def fault_as_json(fault: CellError) -> dict[str, Any]:
    """Number, words and facts."""
    names = ("number", "text", "detail", "cause")
    return {name: getattr(fault, name) for name in names} | {"remedy": remedy_here(fault)}


def remedy_here(fault: CellError) -> str:
    """The remedy without Clear and Reset: nothing is asked while a daemon runs that would take
    them."""
    return _OF_A_DAEMON.sub(". Then ask again.", fault.remedy)


async def answered(path: str, driver: str, question: Coroutine[Any, Any, Answer]) -> Answer:
    """The answer to a question, or an answer that says why there is none. Raises nothing."""
    try:
        return await answer_within(question, path)
    except CellError as fault:
        return Answer(path, driver, fault=fault)
    except Exception as error:  # noqa: BLE001 - a defect of one driver hides no other device
        return Answer(path, driver, fault=Unexpected(f"{path}: {type(error).__name__}: {error}"))


def spread_ms(times_s: Sequence[float]) -> str:
    """Middle, 99th percentile and greatest of times in s, in ms and words."""
    if not times_s:
        return "none"
    p50, p99, most = np.percentile(times_s, [50, 99, 100]) * 1000
    return f"p50 {p50:.1f} ms, p99 {p99:.1f} ms, at most {most:.1f} ms"
