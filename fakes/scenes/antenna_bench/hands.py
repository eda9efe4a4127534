"""The operator at the panel of the arm, who plugs the held module by feel."""

from collections.abc import Iterable

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenes.antenna_bench.scenario import OperatorHands
from fakes.world.connector.contact_lot import MatingPair, Mount
from fakes.world.connector.drawing import SOCKET_T_MATED_PLUG
from fakes.world.frames import MM, displacement
from fakes.world.robot import RefusedMotionError, RobotArm

_KEY_BACK_S = 0.5
"""Time from the end of the last motion until the key is turned back."""


class HandsAtPanel:
    """The key is on manual from the first motion until shortly after the last."""

    def __init__(self, arm: RobotArm) -> None:
        self._arm = arm
        self._way: list[tuple[RigidTransform, float]] = []

    def begin(self, time_s: float, way: Iterable[tuple[RigidTransform, float]]) -> None:
        """Jog to true cell_T_flange poses, each at its own speed (m/s).

        Raises ``ValueError`` where the arm moves already or refuses.
        """
        if self._arm.by_hand or self._arm.moving(time_s):
            raise ValueError("the arm moves: nobody takes over a moving arm")
        self._way = list(way)
        self._arm.by_hand = True
        try:
            self._next(time_s)
        except RefusedMotionError as refusal:
            self._arm.by_hand = False
            raise ValueError(f"the arm cannot be jogged there: {refusal.reason}") from refusal

    def advance(self, time_s: float) -> None:
        """Go on with the next motion, or turn the key back."""
        if not self._arm.by_hand or self._arm.moving(time_s):
            return
        if self._way:
            self._next(time_s)
        elif time_s > self._arm.standstill_s + _KEY_BACK_S:
            self._arm.by_hand = False

    def _next(self, time_s: float) -> None:
        target, speed_m_s = self._way.pop(0)
        self._arm.start_jog(time_s, target, speed_m_s)


def seated_by_hand(
    pair: MatingPair, mount: Mount, hands: OperatorHands, rng: np.random.Generator
) -> RigidTransform:
    """socket_T_plug, the mount not giving way: where a plug sits without a side force.

    Its pins lie on their holes as well as both patterns allow, but for what a hand does not feel.
    """
    unfelt = displacement(
        rng.normal(0, hands.gauge_sigma_mm * MM, 3),
        rng.normal(0, np.deg2rad(hands.gauge_sigma_deg), 3),
    )
    sizes = pair.sizes
    # The contact springs press the plug out: it is held down by as much as the mount gives way.
    held_n = sizes.sliding_share * float((pair.peaks_n * pair.present).sum())
    down_m = sizes.seat_m + held_n / mount.axial_n_m
    down = RigidTransform.from_translation([0.0, 0.0, -down_m])
    return down * unfelt * _pins_on_holes(pair) * SOCKET_T_MATED_PLUG


def _pins_on_holes(pair: MatingPair) -> RigidTransform:
    """Rigid displacement in the plane that lays the pins on their holes, least squares."""
    there = pair.present > 0
    pins, holes = pair.pins_m[there], pair.holes_m[there]
    about, onto = pins - pins.mean(axis=0), holes - holes.mean(axis=0)
    cross = float((about[:, 0] * onto[:, 1] - about[:, 1] * onto[:, 0]).sum())
    turn = Rotation.from_rotvec([0.0, 0.0, np.arctan2(cross, float((about * onto).sum()))])
    shift = np.append(holes.mean(axis=0), 0.0) - turn.apply(np.append(pins.mean(axis=0), 0.0))
    return RigidTransform.from_components(shift, turn)
