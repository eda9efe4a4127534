"""A run as whoever computes it anew reads it: its record, its files, the calibrations it names."""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from cellctl.errors.records.store import NotReplayable
from cellctl.records.entries import Artefact, Calibration, RunRecord

if TYPE_CHECKING:
    from cellctl.records.files.raw_images import GreyImage

PROCEDURE_INPUT = "procedure.input"
"""Document: what the result of a procedure was computed from, with all digits."""


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """One closed run; methods raise ``NotReplayable`` and ``ArtefactDamaged``."""

    record: RunRecord
    read: Callable[[Artefact], bytes]
    """The bytes of a file of the run."""
    calibrations: Mapping[str, Calibration]
    """All of the store, by their ids."""

    @property
    def input(self) -> Mapping[str, Any]:
        """What the result of a procedure was computed from."""
        found = self.record.document(PROCEDURE_INPUT)
        if not found:
            raise NotReplayable(
                f"run {self.record.head.number}, {self.record.head.recipe_name}, has no readings: "
                "it ended before all of them were taken, or an earlier version recorded it"
            )
        # As it was given: the run store gives tuples in place of lists.
        return dict(json.loads(json.dumps(found)))

    def has(self, name: str) -> bool:
        """Whether there is a file of this name."""
        return any(artefact.name == name for artefact in self.record.artefacts)

    def file(self, name: str) -> bytes:
        """The bytes of a file."""
        for artefact in self.record.artefacts:
            if artefact.name == name:
                return self.read(artefact)
        raise NotReplayable(f"{name} is not in the record")

    def image(self, name: str) -> "GreyImage":
        """A raw image, shape (height, width)."""
        # Only here: whoever reads a cell file loads this module too.
        from cellctl.records.files.raw_images import decode

        return decode(self.file(name))

    def require(self, names: Iterable[str]) -> None:
        """Refuse a run of which one of these files is missing.

        Raw images are kept while the run goes on and may be late for its record.
        """
        missing = [name for name in names if not self.has(name)]
        if missing:
            others = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
            raise NotReplayable(f"{missing[0]}{others} is not in the record")
