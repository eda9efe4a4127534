"""Step 50 around the mating itself: plan, further attempts, force curves whatever happens."""

import asyncio
import importlib
from collections.abc import Awaitable, Callable

import numpy as np
import pytest

from cellctl.errors.records.store import RecordNotWritten
from cellctl.errors.robot import HeadMoved
from cellctl.force.contact.curve import ForceCurve
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.deck_to_frame.faults import MatingOverforce
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress, MatingResult
from cellctl.processes.deck_to_frame.state import Corrected
from cellctl.processes.deck_to_frame.steps import MATE
from cellctl.processes.deck_to_frame.steps.correct_pose import correct_pose
from cellctl.processes.deck_to_frame.steps.mate_deck import mate_deck
from cellctl.records.entries import Verdict
from cellctl.runtime.interruption import Interruption
from cellctl.runtime.steps import HeldMeanwhile
from tests.unit.processes.deck_to_frame.rig import RunRig, curve, seated
from tests.unit.processes.deck_to_frame.steps.test_steps import at_the_stand_off

module = importlib.import_module("cellctl.processes.deck_to_frame.steps.mate_deck")
Plan = Callable[[int], Awaitable[MatingPlan]]
Report = Callable[[MatingProgress], None]


PEAKS = ("peak_force", "peak_filtered_force", "peak_lateral", "peak_moment")


class Mating:
    """Stands in for the contact: plans, tells, and ends as the test wants."""

    def __init__(self, attempts: int = 1, fault: BaseException | None = None) -> None:
        self.plans: list[MatingPlan] = []
        self.felt: ForceCurve = curve()
        self._attempts, self._fault = attempts, fault

    async def __call__(
        self,
        robot: object,
        guard: object,
        measured_plan: Plan,
        report: Report,
        *,
        max_tries: int,
        interruption: Interruption,
    ) -> MatingResult:
        for number in range(1, self._attempts + 1):
            self.plans.append(await measured_plan(number))
            report(MatingProgress(MatingPhase.SLOW, 0.009, 0.0))
            report(MatingProgress(MatingPhase.ENDED, 0.01, 36.0, curve=self.felt))
        if self._fault is not None:
            raise self._fault
        return seated(self.plans[-1])


async def ready(rig: RunRig, mating: Mating, monkeypatch: pytest.MonkeyPatch) -> Corrected:
    monkeypatch.setattr(module, "mate_until_seated", mating)
    corrected = await correct_pose(await at_the_stand_off(rig))
    rig.board.update(step=MATE.number, step_label=MATE.label, contact=MATE.contact)
    return corrected


async def test_a_mating_with_its_record(rig: RunRig, monkeypatch: pytest.MonkeyPatch) -> None:
    mating = Mating()
    corrected = await ready(rig, mating, monkeypatch)
    await mate_deck(corrected)
    plan = mating.plans[0]
    assert plan.window.expected_m == pytest.approx(0.010, abs=1e-4)
    assert plan.settings.limit_force_n == rig.bench.recipe.mating.limit_force_n
    assert plan.settings.stale_s == pytest.approx(rig.bench.deck.force_config.stale_ms / 1e3)
    record = await rig.record()
    assert record.document("mating")["outcome"] == "seated"
    assert (record.value("approach.speed") or 0.0) > 0
    peak = record.newest_figures["peak_force"]
    assert (peak.verdict, peak.upper) == (Verdict.PASS, rig.bench.recipe.mating.limit_force_n)
    judged = {key: entry.verdict for key, entry in record.newest_figures.items() if entry.verdict}
    assert {
        "peak_force", "peak_filtered_force", "peak_lateral", "peak_moment", "hold_force",
        "hold_lateral", "seat_gap",
    } <= set(judged)  # fmt: skip
    assert set(judged.values()) == {Verdict.PASS}
    hold, gap = record.newest_figures["hold_force"], record.newest_figures["seat_gap"]
    assert (hold.lower, hold.upper) == (rig.bench.recipe.mating.target_force_n, 45.0)
    assert (gap.lower, gap.upper) == pytest.approx((-0.1, 0.1))
    assert [a.name for a in record.artefacts if "force" in a.name] == ["force-1.mcap"]
    assert rig.board.current.force_peaks[2] == pytest.approx(36.0)
    assert rig.board.current.force_limit_n == rig.bench.recipe.mating.limit_force_n
    assert rig.board.current.message == MatingPhase.ENDED.value


async def test_a_further_attempt_is_measured_and_corrected_anew(
    rig: RunRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    corrected = await ready(rig, Mating(attempts=2), monkeypatch)
    await mate_deck(corrected)
    record = await rig.record()
    assert [entry.number for entry in record.passes] == [1, 2]
    names = [a.name for a in record.artefacts if "force" in a.name]
    assert names == ["force-1.mcap", "force-2.mcap"]
    assert rig.board.current.step == MATE.number
    assert rig.board.current.contact


async def test_a_robot_that_moved_since_it_was_measured_does_not_mate(
    rig: RunRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    corrected = await ready(rig, Mating(), monkeypatch)
    rig.bench.cell.main.flange *= pose_from_xyzabc([0, 0, 0.1, 0, 0, 0])
    with pytest.raises(HeadMoved, match="main robot"):
        await mate_deck(corrected)


@pytest.mark.parametrize("fault", [MatingOverforce("46 N"), asyncio.CancelledError()])
async def test_the_curve_of_a_failure_is_kept(
    rig: RunRig, monkeypatch: pytest.MonkeyPatch, fault: BaseException
) -> None:
    corrected = await ready(rig, Mating(fault=fault), monkeypatch)
    with pytest.raises(type(fault)):
        await mate_deck(corrected)
    record = await rig.record()
    assert any(a.name == "force-1.mcap" for a in record.artefacts)
    assert record.value("approach.speed") is not None
    assert "outcome" not in record.document("mating")
    # Whoever decides about the part needs to know how hard it was pressed, in every direction.
    peaks = {key: record.newest_figures[key] for key in PEAKS}
    assert all(one.verdict is Verdict.PASS and one.value is not None for one in peaks.values())


async def test_a_disk_that_fails_does_not_hide_the_fault(
    rig: RunRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    corrected = await ready(rig, Mating(fault=MatingOverforce("46 N")), monkeypatch)

    def full(*_: object) -> bytes:
        raise RecordNotWritten("disk full")

    rig.bench.cell.workers.answers["encode_curve"] = full
    with pytest.raises(MatingOverforce) as caught:
        await mate_deck(corrected)
    assert any("disk full" in note for note in caught.value.__notes__)


async def test_an_empty_curve_is_no_second_fault(
    rig: RunRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    mating = Mating(fault=MatingOverforce("46 N"))
    mating.felt = ForceCurve(np.zeros(0), np.zeros((0, 6)), np.zeros(0))
    corrected = await ready(rig, mating, monkeypatch)
    with pytest.raises(MatingOverforce):
        await mate_deck(corrected)
    assert np.isnan(rig.board.current.force_peaks).all()


async def test_a_hold_between_attempts_keeps_every_curve_once(
    rig: RunRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    corrected = await ready(rig, Mating(attempts=2), monkeypatch)
    rig.pauses._held_at = (len(rig.pauses.asked) + 1,)
    with pytest.raises(HeldMeanwhile):
        await mate_deck(corrected)
    rig.pauses._held_at = ()
    monkeypatch.setattr(module, "mate_until_seated", Mating())
    await mate_deck(corrected)
    names = [a.name for a in (await rig.record()).artefacts if "force" in a.name]
    assert names == ["force-1.mcap", "force-2.mcap"]
