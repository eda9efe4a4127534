"""Step 10: when it looks, how often, and what it raises; the drive is scripted."""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import timedelta
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from cellctl.clock import utc_now
from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.reference.reference_looks import ReferenceLooks
from cellctl.processes.antenna_module.chain.reference.taught_reference import TaughtReference
from cellctl.processes.antenna_module.chain.teaching.made_with import ReferenceMadeWith
from cellctl.processes.antenna_module.faults.calibration import GripperMarksMoved
from cellctl.processes.antenna_module.last_check import LastCheck
from cellctl.processes.antenna_module.looking import Eyes
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.state import GripperEmpty
from tests.rigs.antenna.exact_cell import cell
from tests.unit.processes.antenna_module.chain.reference_draws import drawn_looks

MOVED: Mapping[str, Array] = {"marks": np.array([60e-6, 0.0])}
EVERY_H = 2.0
# By its name: the package offers the function under the name of the module.
step = importlib.import_module("cellctl.processes.antenna_module.steps.check_reference")


@dataclass
class Recorder:
    """Keeps what is recorded."""

    documents: dict[str, Any] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)

    async def document(self, key: str, content: Mapping[str, Any]) -> None:
        self.documents[key] = content

    async def figure(self, key: str, value: float, unit: str) -> None:
        assert unit == "mm"
        self.values[key] = value


@dataclass
class Rig:
    """A run whose looks are drawn."""

    moved: Mapping[str, Array] = field(default_factory=dict)
    firsts: list[int] = field(default_factory=list)
    """Number of the first look of every drive."""
    recorder: Recorder = field(default_factory=Recorder)
    last_check: LastCheck = field(default_factory=LastCheck)

    def ready(self, *, taught_h: float, plate: bool = True) -> GripperEmpty:
        looks = drawn_looks(12, np.random.default_rng(1))
        plug_cell = cell()
        taught = TaughtReference(
            ReferenceMadeWith.of(plug_cell),
            looks.reading(plug_cell.arm),
            looks.checks(plug_cell.arm),
        )
        made = utc_now() - timedelta(hours=taught_h)
        facts = SimpleNamespace(
            reference=taught if plate else None,
            required_plate=SimpleNamespace(),
            plug_cell=plug_cell,
            calibrations=SimpleNamespace(stored={"reference": SimpleNamespace(made=made)}),
        )
        section = SimpleNamespace(looks=4, every_h=EVERY_H) if plate else None
        run = SimpleNamespace(
            facts=facts,
            cell=SimpleNamespace(settings=SimpleNamespace(reference=section)),
            last_check=self.last_check,
            recorder=self.recorder,
            eyes=Eyes(cast(Any, None), cast(Any, None), recorder=None, frames=3),
            say=lambda _: None,
        )
        return GripperEmpty(cast(PluggingRun, run))

    def drive(self, _facts: object, _plate: object, eyes: Eyes, _tell: object) -> "Rig":
        assert eyes.frames == 1
        return self

    async def looks(self, count: int, *, first: int) -> ReferenceLooks:
        self.firsts.append(first)
        return drawn_looks(count, np.random.default_rng(first), **self.moved)


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Rig:
    made = Rig()
    monkeypatch.setattr(step, "ReferenceDrive", made.drive)
    return made


async def test_nothing_is_looked_at_before_it_is_due(rig: Rig) -> None:
    await step.check_reference(rig.ready(taught_h=EVERY_H / 2))
    assert rig.firsts == []


async def test_a_cell_without_a_plate_has_no_check(rig: Rig) -> None:
    await step.check_reference(rig.ready(taught_h=1000.0, plate=False))
    assert rig.firsts == []


async def test_a_good_check_is_short_and_counts_for_the_next_runs(rig: Rig) -> None:
    await step.check_reference(rig.ready(taught_h=30.0))
    assert rig.firsts == [1]
    assert rig.recorder.values[keys.REFERENCE_MOVED] < 0.01
    await step.check_reference(rig.ready(taught_h=30.0))
    assert rig.firsts == [1]


async def test_what_has_moved_is_looked_at_again_recorded_and_raised(rig: Rig) -> None:
    rig.moved = MOVED
    with pytest.raises(GripperMarksMoved):
        await step.check_reference(rig.ready(taught_h=30.0))
    assert rig.firsts == [1, 5]
    moved_mm = rig.recorder.documents[keys.REFERENCE]["marks_from_axis_mm"]
    assert moved_mm == pytest.approx([0.06, 0.0], abs=0.01)
    with pytest.raises(GripperMarksMoved):
        await step.check_reference(rig.ready(taught_h=30.0))
