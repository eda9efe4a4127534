"""What the board says of each step of a chain while it runs."""

from typing import Any, cast

from cellctl.processes.deck_to_frame.steps import CORRECT_POSE, MATE, MEASURE_FRAME, VERIFY
from cellctl.runtime.progress import ProgressBoard
from cellctl.runtime.steps import StepRunner, Steps, StepSpec


class NoRecord:
    async def phase(self, _number: int, _label: str) -> None:
        pass


async def never(*, hold: bool = False) -> bool:
    assert not hold
    return False


async def ahead_in_each(specs: tuple[StepSpec[Any, Any], ...], *, dry: bool = False) -> list[bool]:
    board, seen = ProgressBoard(), list[bool]()

    async def look(value: int) -> int:
        seen.append(board.current.safe_point_ahead)
        return value

    steps: Steps[int, int] = Steps(
        tuple(
            StepSpec(one.number, one.label, look, one.contact, one.restart, one.safe_points_within)
            for one in specs
        )
    )
    runner = StepRunner(board, never, cast(Any, NoRecord()))
    await runner.run(steps.before_contact() if dry else steps, 0)
    board.leave_step()
    assert board.current.safe_point_ahead, "the next run has one again"
    return seen


async def test_from_the_mating_on_no_safe_point_is_ahead() -> None:
    deck = (MEASURE_FRAME, CORRECT_POSE, MATE, VERIFY)
    assert await ahead_in_each(deck) == [True, True, False, False]


async def test_a_dry_run_may_hold_between_the_measurements_of_its_last_step() -> None:
    deck = (MEASURE_FRAME, CORRECT_POSE, MATE, VERIFY)
    assert await ahead_in_each(deck, dry=True) == [True, True]
