"""Large-field heads of the procedures: what they see of the arm and of the target board."""

from dataclasses import replace

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.interfaces import Target
from tests.contracts.inprocess.target_tracker import InProcessTracker
from tests.rigs.calibration.turned_arm import C_T_BASE, RING, SIGMA_M, flange
from tests.unit.procedures.rig import ProcedureRig

FIELD_SIGMA_M = 7e-6


class Watching:
    """A large-field head that sees the flange's targets, and one that lies about."""

    def __init__(self, rig: ProcedureRig) -> None:
        rig.bench.cell.trackers["tracker"] = self  # type: ignore[assignment]
        rig.renew()
        rig.answer(base_frame_picture=lambda _: b"png")
        self._main = rig.bench.cell.main
        self._rng = np.random.default_rng(0)
        self.frames: list[int] = []
        self.scatter_m = SIGMA_M
        self.mastered_beside_rad = np.zeros(6)
        """How far the arm really stands beside the joints that it reports."""

    async def serial_number(self) -> str:
        return "ET-7"

    async def measure(self, frames: int = 1) -> tuple[Target, ...]:
        self.frames.append(frames)
        c_T_flange = C_T_BASE * flange(self._main.joints_rad + self.mastered_beside_rad)
        places = [
            c_T_flange.apply(place) + self._rng.normal(0, self.scatter_m, 3) for place in RING
        ]
        named = [Target(f"F{n}", place, SIGMA_M) for n, place in enumerate(places, 1)]
        return (*named, Target("P1", np.zeros(3), SIGMA_M))


class Field(InProcessTracker):
    """Averages over many frames; sees what a test puts before it."""

    @classmethod
    def of(cls, rig: ProcedureRig) -> "Field":
        """The one of the rig's cell."""
        field = cls("tracker", {})
        field._connected = True
        rig.bench.cell.tracker = rig.bench.cell.trackers["tracker"] = field
        rig.renew()
        return field

    def see(self, truth: dict[str, Array]) -> None:
        self._truth = truth

    async def measure(self, frames: int = 1) -> tuple[Target, ...]:
        return tuple(
            replace(target, sigma_m=FIELD_SIGMA_M) for target in await super().measure(frames)
        )
