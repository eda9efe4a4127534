"""Procedure 108 through unit and line; only vision and contact are stood in for."""

from typing import Any

import numpy as np
import pytest

from cellctl.calibration.store.envelope import read_calibration
from cellctl.force.contact.commissioning import StiffnessEstimate
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.processes.deck_to_frame.calibrations import CONTACT_STIFFNESS
from cellctl.processes.deck_to_frame.faults import DeckNotSeated
from cellctl.processes.deck_to_frame.mating.commissioning import ContactStiffness
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress
from cellctl.processes.deck_to_frame.procedures import contact_stiffness
from tests.unit.daemon_rig import DaemonRig
from tests.unit.processes.deck_to_frame.rig import curve, seated


class Touching:
    """Stands in for the contacts: each is as stiff as the test wants."""

    def __init__(self) -> None:
        self.plans: list[MatingPlan] = []
        self.steps: list[int] = []
        self.stiffness_n_m = 6e5
        self.fault: Exception | None = None

    async def __call__(
        self, robot: Any, guard: Any, plan: MatingPlan, report: Any
    ) -> ContactStiffness:
        self.plans.append(plan)
        for _ in range(3):
            report(MatingProgress(MatingPhase.ENDED, 0.01, 36.0, curve=curve()))
        if self.fault is not None:
            raise self.fault
        single = StiffnessEstimate(self.stiffness_n_m, 2e4, 0.01, 0.8)
        return ContactStiffness(single, (single,) * 3, (seated(plan),) * 3)


@pytest.fixture
def touching(monkeypatch: pytest.MonkeyPatch) -> Touching:
    touching = Touching()
    monkeypatch.setattr(contact_stiffness, "measure_contact_stiffness", touching)
    return touching


async def commission(daemon_rig: DaemonRig) -> int:
    daemon_rig.bench.world.base_T_frame = daemon_rig.bench.station * pose_from_xyzabc(
        [2, 1, 0, 0, 0, 0.1]
    )
    return await daemon_rig.started(unit_mode=2, recipe_id=108, serial="FRAME-1")


async def test_contact_in_maintenance_leaves_a_run_and_a_calibration(
    daemon_rig: DaemonRig, touching: Touching
) -> None:
    seq = await commission(daemon_rig)
    await daemon_rig.to(State.COMPLETED)
    assert daemon_rig.port.ended[seq] is Result.GOOD
    assert daemon_rig.shown().cycle_counter == 0, "no part was made"
    record = await daemon_rig.record()
    head = record.head
    assert (head.mode, head.serial, head.result, head.recipe_id) == (
        "commissioning", "FRAME-1", "good", 1,
    )  # fmt: skip
    assert [entry.key for entry in record.measurements] == ["frame", "deck", "flange_T_deck"]
    assert record.passes[-1].converged
    assert sum("force" in artefact.name for artefact in record.artefacts) == 3
    stored = read_calibration(daemon_rig.bench.calibrations.path, "contact_stiffness_1")
    assert CONTACT_STIFFNESS.accepted(stored.record)
    assert stored.record["upper_n_per_mm"] == pytest.approx(660.0)
    assert stored.record["recipe_id"] == 1
    assert stored.record["run"] == head.number
    assert (daemon_rig.bench.calibrations.path / "contact_stiffness_1.png").exists()
    await daemon_rig.restart()
    assert daemon_rig.shown().cycle_counter == 0


async def test_the_next_part_is_planned_with_it(daemon_rig: DaemonRig, touching: Touching) -> None:
    touching.stiffness_n_m = 3e5
    await commission(daemon_rig)
    await daemon_rig.to(State.COMPLETED)
    bound = daemon_rig.bench.recipe.mating.stiffness_n_per_mm
    planned = touching.plans[0].speed.figures.stiffness_n_m
    assert planned == pytest.approx(bound * 1e3), "it is itself planned with the bound"
    await daemon_rig.started(unit_mode=1, recipe_id=1)
    await daemon_rig.to(State.COMPLETED)
    record = await daemon_rig.record(2)
    assert record.value("approach.stiffness") == pytest.approx(1.5 * (300.0 + 3 * 20.0))
    assert "contact_stiffness_1" in record.head.calibration_ids
    assert daemon_rig.shown().cycle_counter == 1


async def test_a_bound_that_is_too_low_does_not_pass(
    daemon_rig: DaemonRig, touching: Touching
) -> None:
    touching.stiffness_n_m = 1.2e6
    seq = await commission(daemon_rig)
    await daemon_rig.to(State.ABORTED, State.STOPPED)
    assert daemon_rig.port.ended[seq] is not Result.GOOD
    assert (await daemon_rig.record()).head.fault_number == 615
    assert not (daemon_rig.bench.calibrations.path / "contact_stiffness_1.json").exists()
    assert (daemon_rig.bench.calibrations.path / "rejected" / "contact_stiffness_1.json").exists()


async def test_a_fault_in_contact_closes_the_run_with_its_curves(
    daemon_rig: DaemonRig, touching: Touching
) -> None:
    touching.fault = DeckNotSeated("0.3 mm above the seat")
    await commission(daemon_rig)
    await daemon_rig.to(State.ABORTED, State.STOPPED)
    record = await daemon_rig.record()
    assert record.head.fault_number == 524
    assert sum("force" in artefact.name for artefact in record.artefacts) == 3
    assert np.isfinite(daemon_rig.unit.board.current.force_peaks[2])
