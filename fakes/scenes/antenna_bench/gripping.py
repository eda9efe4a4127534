"""Where the module is: on its tray, in the fingers, in the socket, left, or not there."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.scenes.antenna_bench.scenario import BenchGripper
from fakes.world.frames import MM, Array, displacement, distance, from_written, stream
from fakes.world.gripper import ON_PART, OPEN_END, PneumaticJaws
from fakes.world.truth import drawn_spread

Place = Literal["tray", "gripper", "socket", "left", "absent"]
_HOLDING = 0.02
"""Ratio of the travel before the part at which the jaws hold it."""
_FREE = 0.3
"""Ratio of the travel by which the jaws have opened from the part when they let it go. Much more
than ``_HOLDING``, so that jaws that rest on the part cannot grip and let go in turn."""


@dataclass(slots=True)
class ModulePlace:
    """The module in or beside the fingers."""

    settings: BenchGripper
    seed: int
    place: Place
    cell_T_plug: RigidTransform
    """Where it is while nothing holds it."""
    flange_T_plug: RigidTransform
    """Where it is in the fingers while they hold it."""
    faults: FaultBoard
    grips: int = 0
    _cell_T_pocket: RigidTransform = field(init=False)
    """Where the tray's pocket holds it."""

    def __post_init__(self) -> None:
        self._cell_T_pocket = self.cell_T_plug

    def follow(
        self,
        jaws: PneumaticJaws,
        flange: Array,
        *,
        rests_at: Callable[[RigidTransform], RigidTransform],
        in_socket: bool,
    ) -> None:
        """Take over what the jaws did.

        ``flange`` is the matrix cell_T_flange; ``rests_at`` gives the true cell_T_plug of a flange;
        ``in_socket`` when the socket would keep the module.
        """
        if self.place == "absent":
            jaws.part_present = False
            return
        held = self.place == "gripper"
        if held and jaws.last_position < ON_PART - _FREE:
            self._let_go(rests_at(RigidTransform.from_matrix(flange)), in_socket=in_socket)
        elif not held:
            cell_T_flange = RigidTransform.from_matrix(flange)
            between = self._between(cell_T_flange)
            # Jaws that have closed beyond the part have nothing to hold any more.
            if jaws.last_position <= ON_PART:
                jaws.part_present = between
            closed = ON_PART - _HOLDING <= jaws.last_position <= ON_PART
            if between and closed and jaws.last_position > OPEN_END:
                self._grip(cell_T_flange)

    def slip(self, axial_n: float, seconds: float) -> None:
        """Let the module slip back between the fingers under too high a force, either way."""
        if abs(axial_n) <= self.settings.slip_force_n:
            return
        way_m = self.settings.slip_mm_s * MM * seconds * (1.0 if axial_n > 0 else -1.0)
        self.flange_T_plug *= RigidTransform.from_translation([0.0, 0.0, -way_m])

    def now(self, cell_T_flange: RigidTransform) -> RigidTransform:
        """cell_T_plug, the module's springs not giving way."""
        if self.place == "gripper":
            return cell_T_flange * self.flange_T_plug
        return self.cell_T_plug

    def _let_go(self, cell_T_plug: RigidTransform, *, in_socket: bool) -> None:
        """It stays in the socket, slides into the pocket of the tray, or hangs where it was left.

        The pocket has chamfers as wide as the jaws open, so that it takes what they can take.
        """
        self.cell_T_plug, self.place = cell_T_plug, "left"
        if in_socket:
            self.place = "socket"
        elif distance(cell_T_plug, self._cell_T_pocket)[0] < self.settings.grip_range_mm * MM:
            self.cell_T_plug, self.place = self._cell_T_pocket, "tray"

    def _between(self, cell_T_flange: RigidTransform) -> bool:
        nominal = cell_T_flange * from_written(self.settings.flange_T_plug_mm_deg)
        away_m, _ = distance(nominal, self.cell_T_plug)
        return away_m < self.settings.grip_range_mm * MM

    def _grip(self, cell_T_flange: RigidTransform) -> None:
        """The fingers take the module as it lies, and it settles in their play."""
        self.grips += 1
        play = drawn_spread(stream(self.seed, "grip", self.grips), self.settings.play)
        fault = self.faults.use("grip_off")
        if fault is not None:
            off_m = np.array([fault.number("x_mm", 2.5), fault.number("y_mm", 0.0), 0.0]) * MM
            play *= displacement(off_m, [0.0, 0.0, np.deg2rad(fault.number("yaw_deg", 0.0))])
        self.flange_T_plug = cell_T_flange.inv() * self.cell_T_plug * play
        self.place = "gripper"
