"""Procedure 206: taught by some plugs, checked with further ones; plugs by hand are scripted."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.calibrations import PLUG_CORRECTION
from cellctl.processes.antenna_module.chain.schemes import DIFFERENCE
from cellctl.processes.antenna_module.chain.teaching.teaching import TaughtPlug
from cellctl.processes.antenna_module.faults.calibration import TeachScatter
from cellctl.processes.antenna_module.procedures import teach_plug
from cellctl.processes.antenna_module.record import keys
from tests.rigs.antenna import exact_cell as exact
from tests.unit.processes.antenna_module.steps.notes import Notes

SEATED = pose_from_xyzabc([0.03, -0.05, 0.2, 0.1, 0, 0])
TAUGHT, CHECKED = 4, 2


class Panel:
    """Somebody who plugs; ``moved`` plugs sit elsewhere."""

    def __init__(self, moved: tuple[int, ...] = ()) -> None:
        self.plugs = exact.taught_plugs(TAUGHT + CHECKED, SEATED)
        aside = RigidTransform.from_translation([2e-4, 0.0, 0.0])
        for number in moved:
            plug = self.plugs[number]
            self.plugs[number] = replace(plug, base_T_flange=aside * plug.base_T_flange)
        self.notes = Notes()
        self.looked_at_files = False
        self.names: list[str] = []
        self.told: list[str] = []

    async def one_plug(self, _run: object, name: str) -> TaughtPlug:
        self.names.append(name)
        return replace(self.plugs[len(self.names) - 1], name=name)

    async def progress(self, done: int, total: int, message: str) -> None:
        self.told.append(f"{message} {done} of {total}")

    async def taught(self, monkeypatch: pytest.MonkeyPatch) -> Any:
        async def facts(*_of: object, **_how: object) -> SimpleNamespace:
            calibrations = SimpleNamespace(records=())
            return SimpleNamespace(
                plug_cell=exact.cell(), scheme=DIFFERENCE, calibrations=calibrations
            )

        async def opened(*_of: object) -> int:
            assert self.looked_at_files, "the record shows files that nobody has looked at"
            return 1

        async def looked(_recipe: object) -> None:
            self.looked_at_files = True

        async def in_worker(job: Any, *arguments: object) -> Any:
            return job(*arguments)

        monkeypatch.setattr(teach_plug, "read_facts", facts)
        monkeypatch.setattr(teach_plug, "RunRecorder", lambda *_of: self.notes)
        monkeypatch.setattr(teach_plug, "PluggingRun", SimpleNamespace(of=lambda *_of, **_how: 0))
        monkeypatch.setattr(teach_plug, "_one_plug", self.one_plug)
        settings = SimpleNamespace(taught_plugs=TAUGHT, checked_plugs=CHECKED)
        cell: Any = SimpleNamespace(settings=settings, workers=SimpleNamespace(run=in_worker))
        context: Any = SimpleNamespace(
            record=SimpleNamespace(open=opened, look_at_files=looked),
            safe_point=None,
            progress=self.progress,
        )
        services: Any = SimpleNamespace(calibrations=None, store=None)
        recipe: Any = SimpleNamespace(id=1)
        return await teach_plug.teach_plug_on_cell(cell, recipe, services, context)


async def test_further_plugs_are_asked_for_and_only_checked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    panel = Panel()
    outcome = await panel.taught(monkeypatch)
    assert panel.names == [
        "plug 1",
        "plug 2",
        "plug 3",
        "plug 4",
        "checked plug 1",
        "checked plug 2",
    ]
    assert panel.told[-1] == "plug 6 of 6"
    assert outcome.passed
    correction = PLUG_CORRECTION.result(outcome.record)
    assert correction.slots[0].plugs == TAUGHT
    assert {"checked plug 1: offset", "checked plug 2: yaw"} <= {
        check.name for check in correction.checks
    }
    assert panel.notes.artefacts == [keys.TAUGHT_PICTURE]


async def test_a_correction_that_further_plugs_contradict_does_not_pass(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    outcome = await Panel(moved=(5,)).taught(monkeypatch)
    assert not outcome.passed
    checks = PLUG_CORRECTION.result(outcome.record).checks
    failed = [check.name for check in checks if not check.passed]
    assert failed == ["checked plug 2: offset"]


async def test_plugs_that_scatter_are_refused_before_anybody_plugs_for_a_check(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    panel = Panel(moved=(2,))
    with pytest.raises(TeachScatter, match="plug 3"):
        await panel.taught(monkeypatch)
    assert panel.names[-1] == "plug 4"
