"""The procedures that move the main robot move it under its force guard."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from cellctl.cell.guarded_motion.free_moves import free_tolerance, guarded_section
from cellctl.errors.base import CellError
from cellctl.guard.report import TareResult
from cellctl.runtime.steps import HeldMeanwhile
from tests.unit.cell.bench import make_bench
from tests.unit.procedures.rig import ProcedureRig


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[ProcedureRig]:
    rig = ProcedureRig(make_bench(tmp_path), tmp_path / "store")
    yield rig
    rig.archive.close()


@pytest.mark.parametrize("number", [103, 106, 107])
async def test_it_arms_the_guard_for_its_moves(rig: ProcedureRig, number: int) -> None:
    rig.pauses._held_at = (2,)
    main, guard = rig.bench.cell.main, rig.bench.cell.guard
    with pytest.raises((HeldMeanwhile, CellError)):
        await rig.procedures[number].run(rig.context)
    # The robot of the bench refuses to move while its guard is not armed.
    assert len(main.moves) >= 2
    assert guard.asked.count("arm") == 2, "for the way home, and for the procedure"
    force_n = rig.bench.deck.force_config.free_force_n
    assert {limits.filtered[0] for limits in guard.limits} == {force_n}


async def test_without_the_guard_nothing_moves(rig: ProcedureRig) -> None:
    rig.bench.cell.guard.faults["arm"] = CellError("no fresh samples")
    with pytest.raises(CellError, match="no fresh samples"):
        await rig.procedures[106].run(rig.context)
    assert not rig.bench.cell.main.moves


async def test_a_load_that_nobody_has_identified_may_be_felt_as_far_as_the_arm_tilts(
    rig: ProcedureRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    deck, guard = rig.bench.deck, rig.bench.cell.guard
    guard.gravity_compensated = False

    async def tare(_: float) -> TareResult:
        return TareResult(np.array([0.0, 30.0, -1990.0, 1.0, 2.0, 3.0]), np.ones(6), 100)

    monkeypatch.setattr(guard, "tare", tare)
    async with guarded_section(deck.arm, free_tolerance(deck.arm)):
        assert guard.armed
    assert not guard.armed
    assert guard.limits[0].filtered[0] == pytest.approx(
        deck.force_config.free_force_n + 1990.2, rel=1e-4
    )
