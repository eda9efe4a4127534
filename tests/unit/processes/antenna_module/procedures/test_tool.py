"""Procedures 207 and 208: the tool by turning over camera II, and by touches at the panel."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.solvers.tool.tool import ToolResult
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.interfaces import RobotMode
from cellctl.processes.antenna_module.calibrations import CALIBRATIONS, TOOL, TOOL_TURN
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop
from cellctl.processes.antenna_module.faults.calibration import NobodyTouched
from cellctl.processes.antenna_module.moves.kept_look import KeptLook
from cellctl.processes.antenna_module.procedures import touch_tool, turn_tool
from cellctl.processes.antenna_module.procedures.by_hand import Patience
from cellctl.processes.antenna_module.procedures.procedure_list import antenna_procedures
from cellctl.runtime.procedure import ProcedureContext
from tests.rigs.antenna import exact_cell
from tests.rigs.procedure_record import Kept
from tests.unit.processes.antenna_module.procedures.panel import (
    FLANGE_T_TIP,
    POINT_M,
    Panel,
    in_worker,
    orienting,
    touched,
    touching,
    with_tip_at,
)
from tests.unit.processes.antenna_module.steps.bench import Bench


async def test_touches_give_place_and_axes_of_the_tip(monkeypatch: pytest.MonkeyPatch) -> None:
    panel = Panel(poses=touching() + orienting())
    outcome = await touched(panel, monkeypatch)
    assert (outcome.kind, outcome.passed) == (TOOL, True)
    result: ToolResult = TOOL.result(outcome.record)
    off = result.flange_T_tool.pose.inv() * FLANGE_T_TIP
    assert np.linalg.norm(off.translation) < 1e-6
    assert off.rotation.magnitude() < 1e-6
    assert outcome.picture_png.startswith(b"\x89PNG")
    assert panel.told[0] == "1/11 by hand: tip on the point, tilted anew,"
    assert panel.told[-1] == "11/11 by hand: tip to the side of its y axis,"


def test_what_is_asked_for_is_never_refused() -> None:
    poses = touching() + orienting()
    assert not any(touch_tool.what_is_wrong(pose, poses[:at]) for at, pose in enumerate(poses))


def test_a_touch_that_is_not_what_was_asked_for_is_not_taken() -> None:
    tips, axes = touching(), orienting()
    hardly = RigidTransform.from_rotation(Rotation.from_euler("x", 6.0, degrees=True))
    assert "6° against touch 2" in touch_tool.what_is_wrong(tips[1] * hardly, tips[:4])
    assert "flange was turned" in touch_tool.what_is_wrong(axes[1] * hardly, [*tips, axes[0]])
    near = with_tip_at(axes[0].rotation, POINT_M + np.array([4e-3, 0.0, 0.0]))
    assert "4 mm from the point" in touch_tool.what_is_wrong(near, [*tips, axes[0]])


async def test_a_touch_that_is_not_taken_is_asked_for_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    panel = Panel(poses=touching() + orienting())
    slips = iter(["", "turned by 3° against touch 1", *[""] * 20])
    monkeypatch.setattr(touch_tool, "what_is_wrong", lambda *_pose: next(slips))
    outcome = await touched(panel, monkeypatch)
    assert outcome.passed
    assert panel.told[1:3] == [
        "2/11 by hand: tip on the point, tilted anew,",
        "2/11 not taken, turned by 3° against touch 1; by hand: tip on the point, tilted anew,",
    ]


async def test_nobody_at_the_panel_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    panel = Panel(poses=touching())
    panel.state = lambda: SimpleNamespace(mode=RobotMode.REMOTE)  # type: ignore[method-assign]
    with pytest.raises(NobodyTouched):
        await touched(panel, monkeypatch, Patience(wait_s=0.0))


@dataclass
class Turning:
    """The marks as they are seen round the axis, camera II 0.4 mm beside where it is said to be."""

    bench: Bench
    marks_mm: tuple[float, float] = (0.15, -0.1)
    homes: int = 0
    kept: tuple[KeptLook, ...] = ()

    def drive(self, *_of: object) -> "Turning":
        return self

    async def stop(self, angle_rad: float, _name: str) -> TurnStop:
        over = pose_from_xyzabc((500.0, 100.0, 500.0, 20.0, 0.0, 180.0))
        turn = RigidTransform.from_rotation(Rotation.from_euler("z", angle_rad))
        self.bench.base_T_flange = over * turn
        marks_m = self.bench.base_T_flange.rotation.apply(np.array([*self.marks_mm, 0.0]) * MM)
        return TurnStop(angle_rad, marks_m[:2] + np.array([0.4e-3, 0.0]))

    async def to_taught(self, pose: str) -> None:
        assert pose == "home"
        self.homes += 1


async def turned(turning: Turning, monkeypatch: pytest.MonkeyPatch) -> Any:
    async def facts(*_of: object, **_how: object) -> SimpleNamespace:
        return SimpleNamespace(plug_cell=exact_cell.cell())

    async def left(_cell: object) -> None:
        return

    monkeypatch.setattr(turn_tool, "read_facts", facts)
    monkeypatch.setattr(turn_tool, "leave_stations", left)
    monkeypatch.setattr(turn_tool, "TurnDrive", turning.drive)
    monkeypatch.setattr(turn_tool, "Mover", turning.drive)
    run = turning.bench.run()
    cell: Any = run.cell
    cell.workers = SimpleNamespace(run=in_worker)
    return await turn_tool.turn_tool_on_cell(
        cell, run.recipe, cast(Any, SimpleNamespace(calibrations=None)),
        cast(ProcedureContext, Kept()),
    )  # fmt: skip


async def test_turning_gives_the_marks_beside_the_axis(monkeypatch: pytest.MonkeyPatch) -> None:
    turning = Turning(Bench())
    outcome = await turned(turning, monkeypatch)
    assert (outcome.kind, outcome.passed, turning.homes) == (TOOL_TURN, True, 1)
    result = TOOL_TURN.result(outcome.record)
    assert np.linalg.norm(result.offset_m) == pytest.approx(np.hypot(0.15, 0.1) * MM, abs=1e-9)
    (beside,) = (check for check in result.checks if check.name == "marks beside their drawing")
    # The camera's own error has dropped out.
    assert beside.value == pytest.approx(np.hypot(0.15, 0.1), abs=1e-6)
    assert outcome.picture_png.startswith(b"\x89PNG")


async def test_marks_far_from_their_drawing_do_not_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = await turned(Turning(Bench(), marks_mm=(1.2, 0.0)), monkeypatch)
    assert not outcome.passed


def test_both_are_offered_and_production_does_without() -> None:
    bench = Bench()
    settings = SimpleNamespace(validity_days=30, reference=None)
    cell: Any = SimpleNamespace(settings=settings)
    offered = {one.number: one for one in antenna_procedures(cell, [bench.recipe], cast(Any, None))}
    assert {207, 208} <= offered.keys()
    # Plugs are taught of a recipe, which the record has to name; the others need no module.
    assert {number for number, one in offered.items() if one.opens_record} == {206, 20_601}
    assert {TOOL, TOOL_TURN} <= set(CALIBRATIONS)
    assert not TOOL.required
    assert not TOOL_TURN.required
