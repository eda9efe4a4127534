"""The record of a procedure, kept in the test, and the recorded run that it becomes."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from cellctl.interfaces.stereo_camera import Image
from cellctl.records.entries import Artefact, Calibration, Document, RunHead, RunRecord
from cellctl.records.files.raw_images import MEDIA_TYPE
from cellctl.records.replay.procedure_result import STORED, check_figures
from cellctl.records.replay.recorded_run import PROCEDURE_INPUT, RecordedRun
from cellctl.runtime.procedure import ProcedureOutcome
from tests.rigs.raw_images import coded

NOW = datetime(2026, 1, 1, tzinfo=UTC)


@dataclass
class Kept:
    """What a procedure is given, without a store: it keeps input and images."""

    told: list[str] = field(default_factory=list)
    given: dict[str, Any] = field(default_factory=dict)
    images: dict[str, Image] = field(default_factory=dict)
    files: dict[str, bytes] = field(default_factory=dict)
    """Further files of the run."""

    async def progress(self, done: int, total: int, message: str) -> None:
        self.told.append(f"{done}/{total} {message}")

    async def keep_input(self, content: Mapping[str, Any]) -> None:
        # As a store would give it back.
        self.given = json.loads(json.dumps(content))

    def new_look(self, look: str) -> str:
        return look

    @property
    def recorder(self) -> "Kept":
        return self

    async def exposures(self, _taken: object) -> None:
        return

    async def add(self, *_details: object) -> None:
        return

    def raw_image(self, name: str, image: Image) -> None:
        self.images[name] = image

    def run(self, outcome: ProcedureOutcome) -> RecordedRun:
        """The run in which this was found, with its result stored."""
        item = outcome.kind.name
        record = json.loads(json.dumps(outcome.record))
        stored = Calibration("id", item, outcome.serial_number, "cellctl", NOW, NOW, record)
        documents = (
            Document(PROCEDURE_INPUT, self.given),
            Document(STORED, {"item": item, "id": "id"}),
        )
        files = self.files | {name: coded(image) for name, image in self.images.items()}
        artefacts = tuple(Artefact(NOW, file, file, 1, MEDIA_TYPE) for file in files)
        run = RunRecord(
            HEAD, (), tuple(check_figures(item, record)), (), (), documents, artefacts, (), (), (),
            None,
        )  # fmt: skip
        return RecordedRun(run, lambda one: files[one.name], {"id": stored})


HEAD = RunHead(
    number=1, process="maintenance", serial="", recipe_id=200, recipe_name="calibrate",
    recipe_hash="", mode="maintenance", operator="", software="cellctl", config_hash="",
    simulated=True, calibration_ids={}, started=NOW, ended=NOW, result="good",
    fault_number=None, fault=None, record_schema=1,
)  # fmt: skip
Replays = Callable[[RecordedRun], Any]


def differing(replay: Replays, run: RecordedRun) -> dict[str, float]:
    """Difference by name, of what does not come out the same; there is something to compare."""
    lines = list(replay(run))
    assert len(lines) > 3
    return {line.name: line.difference for line in lines if not line.identical}
