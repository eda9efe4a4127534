"""Somebody at the panel is waited for: the key goes to manual and back, and the arm stands."""

from types import SimpleNamespace
from typing import Any

import pytest

from cellctl.interfaces import RobotMode
from cellctl.processes.antenna_module.faults.calibration import NobodyPlugged, NobodyTouched
from cellctl.processes.antenna_module.procedures.by_hand import Patience, jogged_by_hand


def panel(*states: tuple[RobotMode, bool]) -> tuple[Any, list[tuple[RobotMode, bool]]]:
    """A robot that shows these states, mode and whether it moves, one at each question; and those
    that were not asked for yet."""
    left = list(states)

    def state() -> SimpleNamespace:
        mode, moving = left.pop(0) if len(left) > 1 else left[0]
        return SimpleNamespace(mode=mode, moving=moving, ready=mode is RobotMode.REMOTE)

    return SimpleNamespace(state=state), left


async def test_it_is_over_when_the_key_is_back_and_the_arm_stands() -> None:
    robot, left = panel(
        (RobotMode.REMOTE, False),
        (RobotMode.MANUAL, True),
        (RobotMode.MANUAL, False),
        (RobotMode.REMOTE, True),
        (RobotMode.REMOTE, False),
        (RobotMode.REMOTE, False),
    )
    await jogged_by_hand(robot, NobodyPlugged, Patience(poll_s=0.0))
    assert len(left) == 1


@pytest.mark.parametrize("nobody", [NobodyPlugged, NobodyTouched])
@pytest.mark.parametrize("mode", [RobotMode.REMOTE, RobotMode.MANUAL])
async def test_a_key_that_is_never_turned_or_never_turned_back_has_an_end(
    mode: RobotMode, nobody: type[NobodyPlugged | NobodyTouched]
) -> None:
    robot, _ = panel((mode, False))
    with pytest.raises(nobody, match="0 minutes"):
        await jogged_by_hand(robot, nobody, Patience(wait_s=0.0, poll_s=0.0))
