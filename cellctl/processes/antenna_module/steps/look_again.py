"""A look whose picture could not be used is taken a second time, once in a run."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TypeVar

from cellctl.errors import CellError
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorMissing,
    ConnectorUncertain,
    ContactHidden,
    MarksMissing,
)
from cellctl.processes.antenna_module.faults.plugging import LooksDisagree
from cellctl.processes.antenna_module.moves.places import AWAY_M, raised
from cellctl.processes.antenna_module.record import keys
from cellctl.processes.antenna_module.run import PluggingRun

T = TypeVar("T")
BY_CHANCE: tuple[type[CellError], ...] = (
    ConnectorMissing,
    ConnectorUncertain,
    ContactHidden,
    MarksMissing,
    LooksDisagree,
)
"""A reflection, a shadow, an arm that still swung: another picture may be good. What a picture says
of the part itself (missing, bent, turned, another connector) a second one says again."""


@dataclass(frozen=True, slots=True)
class SecondLook:
    """Looks of one run, of which one may be taken again."""

    run: PluggingRun

    async def look(self, images: str, taken: Callable[[str], Awaitable[T]]) -> T:
        """What ``taken`` makes of a look from where the arm is; ``images`` names the raw images.

        Raises what ``taken`` raises: at once where a second picture would show the same, or where
        the second look of the run is used up; else what the second one raises.
        """
        try:
            return await taken(images)
        except BY_CHANCE as first:
            if self.run.second_looks:
                raise
            self.run.second_looks.append(images)
            await self.run.recorder.document(
                keys.SECOND_LOOK, {"look": images, "first": str(first)}
            )
            await self._approach_anew()
            try:
                return await taken(f"{images}-again")
            except CellError as second:
                second.add_note(f"the first look: {first}")
                raise

    async def _approach_anew(self) -> None:
        """Up and back to the same place: constant errors cancel only there."""
        self.run.say("look again")
        here = self.run.cell.arm.robot.state().base_T_flange
        await self.run.mover.to(raised(here, AWAY_M))
        await self.run.mover.to(here)
