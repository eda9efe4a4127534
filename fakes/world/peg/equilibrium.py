"""Where a massless peg stands between the spring of the robot and its contacts.

Solves K (commanded - X) + W(X) - D (X - before) / dt = 0 for the pose X by Newton's method, with
the Jacobian written by hand. W holds normal forces, friction with its bristles, and the contacts
inside a connector.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.linalg.lapack import dgesv

from fakes.world.frames import Array
from fakes.world.peg.attitude import Pose6
from fakes.world.peg.contact import Contact
from fakes.world.peg.fit import Fit
from fakes.world.peg.friction import SHARE, Bristles, rub
from fakes.world.peg.slots import Slots, among_contacts

_ROUNDS: Final = 12
_RELAXING: Final = 60
_RELAXED: Final = np.diag([2e6] * 3 + [50.0] * 3)
"""Further rounds as a slow slide, with this stiffness against every step. Where a contact goes over
the edge between chamfer and bore no equilibrium is near, and Newton's steps jump to and fro."""
_ROUNDS_CREEPING: Final = 4
_RELAX_EVERY: Final = 10
"""A peg that creeps gets few rounds, and the slow slide only now and then: with all of them a
second of creeping takes several seconds, and the fake cell falls silent for its clients."""
_BACKWARDS: Final = 0.3
"""A step of Newton's is cut back where what drives the peg points back along it by more than this
share. Friction that turns round within a step would have the peg jump to and fro else."""
_FOUND_M: Final = 2e-8
_FOUND_RAD: Final = 2e-6
"""Newton's last step. Within it forces are linear, and are carried along with it."""
_CREEP: Final = [20e-6] * 3 + [1e-3] * 3
"""Largest motion of the peg where Newton finds nothing. Held in place, a free peg would look
captured; let go at once, it would run away."""
_DRAG: Final = np.array([10.0] * 3 + [1e-3] * 3)
"""N·s/m and N·m·s/rad: keeps a peg that nothing holds in place."""
_SPRING_GIVES_M: Final = 20e-6
"""Contacts inside a connector pull back when the plug has turned round by this much."""
_INSIDE: Final = -1
"""Number of the bristle of these contacts."""

_NOWHERE: Final = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

Row = tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Equilibrium:
    """The peg at the end of a step."""

    pose: Pose6
    wrench: Array
    """Wrench of what it touches, about its tip, in the axes of the hole: N, N·m, shape (6,)."""
    bristles: Bristles
    slots: tuple[int, ...]
    """Slots that are in contact."""
    way: Pose6
    """Motion of the peg in this step."""
    crept: int = 0
    """Steps in a row in which Newton failed and the peg crept."""

    @property
    def found(self) -> bool:
        """False where the peg crept."""
        return self.crept == 0


def settle(
    slots: Slots, robot_n_m: Array, commanded: Pose6, last: Equilibrium, dt_s: float
) -> Equilibrium:
    """One step of time. ``robot_n_m`` is the 6x6 stiffness of everything that holds the peg."""
    step = _Step(slots, robot_n_m, commanded, last, dt_s)
    start = _moved(last.pose, last.way)  # a steady motion goes on
    rounds, relaxing = _effort(last.crept)
    found, pose = step.search(start, rounds, cuts=True)
    if found is None:
        # Where a peg falls over an edge, whole steps may still find where it comes to stand.
        found, pose = step.search(start, rounds, relaxing)
    return found or step.crept(pose)


class _Step:
    """What is the same for all poses that are tried in one step of time."""

    def __init__(
        self, slots: Slots, robot_n_m: Array, commanded: Pose6, last: Equilibrium, dt_s: float
    ) -> None:
        drag = _DRAG / dt_s
        self._slots, self._robot_n_m, self._commanded, self._last = (
            slots, robot_n_m, commanded, last,
        )  # fmt: skip
        self._held = robot_n_m + np.diag(drag)
        self._wanted = robot_n_m @ commanded + drag * last.pose

    def search(
        self, pose: Pose6, rounds: int, relaxing: int = 0, *, cuts: bool = False
    ) -> tuple[Equilibrium | None, Pose6]:
        """Newton's method from a pose, then the slow slide; where nothing is found, its last."""
        load, residual = self._at(pose)
        for number in range(rounds + relaxing):
            jacobian = load.jacobian()
            system = self._held + jacobian
            if number >= rounds:
                system += _RELAXED
            step = _solved(system, residual.copy())
            way = step.tolist()
            pose = _moved(pose, way)
            if max(map(abs, way[:3])) < _FOUND_M and max(map(abs, way[3:])) < _FOUND_RAD:
                load.wrench -= jacobian @ step
                return load.standing(pose), pose
            driven = float(residual @ step)
            load, residual = self._at(pose)
            if cuts and (beyond := _beyond(float(residual @ step), driven)):
                pose = _moved(pose, (-beyond * step).tolist())
                load, residual = self._at(pose)
        return None, pose

    def crept(self, pose: Pose6) -> Equilibrium:
        """The peg a little on its way to a pose that is none of equilibrium."""
        crept = tuple(
            old + max(-limit, min(limit, new - old))
            for old, new, limit in zip(self._last.pose, pose, _CREEP, strict=True)
        )
        pose = (crept[0], crept[1], crept[2], crept[3], crept[4], crept[5])
        load, _ = self._at(pose)
        # What the arm presses with is all that can be carried.
        load.wrench = -(self._robot_n_m @ (np.array(self._commanded) - pose))
        return load.standing(pose, crept=self._last.crept + 1)

    def _at(self, pose: Pose6) -> tuple["_Load", Array]:
        """The contacts at a pose, and what drives the peg on from it."""
        last = self._last
        load = _Load(self._slots.fit, self._slots.active(pose), pose, last.pose, last.bristles)
        return load, self._wanted - self._held @ pose + load.wrench


def _solved(system: Array, residual: Array) -> Array:
    """``np.linalg.solve`` for one system, without its checks: they take five times as long."""
    *_, step, singular = dgesv(system, residual, overwrite_a=True, overwrite_b=True)
    if singular:
        raise np.linalg.LinAlgError("stiffness of arm and contacts is singular")
    return np.asarray(step)


def _beyond(drives: float, driven: float) -> float:
    """Share of a step to go back, to where what drives along it would vanish if it were linear.

    ``drives`` is the product of step and residual at its end, ``driven`` that at its begin.
    """
    return drives / (drives - driven) if drives < -_BACKWARDS * driven < 0.0 else 0.0


def _effort(crept: int) -> tuple[int, int]:
    """Rounds of Newton, and of the slow slide, after so many steps without an equilibrium."""
    if crept == 0:
        return _ROUNDS, _RELAXING
    return _ROUNDS_CREEPING, _RELAXING if crept % _RELAX_EVERY == 0 else 0


def free_at(pose: Pose6) -> Equilibrium:
    """A peg that touches nothing."""
    return Equilibrium(pose, np.zeros(6), {}, (), _NOWHERE)


class _Load:
    """Forces of the contacts at one pose, with the rows of their Jacobian."""

    def __init__(
        self, fit: Fit, contacts: list[Contact], pose: Pose6, before: Pose6, bristles: Bristles
    ) -> None:
        # One number after the other: numpy takes several times as long for rows within a list.
        self._left: list[float] = []
        self._right_sizes: list[float] = []
        self._right: list[float] = []
        self._sizes: list[float] = []
        self._rows: list[float] = []
        self._bristles: Bristles = {}
        self._contacts, self._before = contacts, before
        moved = _difference(pose, before)
        for contact in contacts:
            self._add(contact, moved, bristles, fit.friction)
        if among_contacts(fit, pose):
            self._add_inside(fit, pose[2], moved[2], bristles)
        self.wrench = np.zeros(6)
        if self._sizes:
            self.wrench = np.array(self._sizes) @ np.array(self._rows).reshape(-1, 6)

    def jacobian(self) -> Array:
        """Minus the derivative of the wrench against the pose, shape (6, 6)."""
        if not self._left:
            return np.zeros((6, 6))
        left = np.array(self._left).reshape(-1, 6)
        right = np.array(self._right).reshape(-1, 6)
        return np.asarray(left.T @ (np.array(self._right_sizes)[:, None] * right))

    def standing(self, pose: Pose6, *, crept: int = 0) -> Equilibrium:
        slots = tuple(contact.slot for contact in self._contacts)
        way = _NOWHERE if crept else _difference(pose, self._before)
        return Equilibrium(pose, self.wrench, self._bristles, slots, way, crept)

    def _derivative(self, left: Row, size: float, right: Row) -> None:
        self._left += left
        self._right_sizes.append(size)
        self._right += right

    def _force(self, size: float, row: Row) -> None:
        self._sizes.append(size)
        self._rows += row

    def _add(self, contact: Contact, moved: Pose6, bristles: Bristles, friction: float) -> None:
        normal_n = contact.stiffness_n_m * contact.depth_m
        if contact.twist:
            row = (0.0, 0.0, 0.0, 0.0, 0.0, contact.nz)
            self._force(normal_n, row)
            self._derivative(row, contact.stiffness_n_m, row)
            return
        pressed = _row(contact, contact.nx, contact.ny, contact.nz)
        self._force(normal_n, pressed)
        self._derivative(pressed, contact.stiffness_n_m, pressed)
        if contact.around_m > 0.0:
            self._turning_normal(contact, normal_n)
        if friction == 0.0:
            return
        rubbed = rub(contact, bristles, moved, friction)
        self._bristles[contact.slot] = rubbed.deflection
        along, across = _row(contact, *rubbed.along), _row(contact, *rubbed.across)
        self._force(-rubbed.force_n, along)
        stiffness = rubbed.force_n / rubbed.trial_m if rubbed.trial_m > 1e-15 else 0.0
        if rubbed.slips:
            self._derivative(along, -friction * contact.stiffness_n_m, pressed)
        else:
            # A bristle that is not bent yet has no force to divide by its length.
            stiffness = stiffness or SHARE * contact.stiffness_n_m
            self._derivative(along, stiffness, along)
        self._derivative(across, stiffness, across)

    def _turning_normal(self, contact: Contact, normal_n: float) -> None:
        """The normal follows the azimuth at which the peg leans on a round wall."""
        level = (contact.nx * contact.nx + contact.ny * contact.ny) ** 0.5
        if level < 1e-9:
            return
        tx, ty = -contact.ny / level, contact.nx / level
        force = _row(contact, tx, ty, 0.0)
        motion = (tx, ty, 0.0, -contact.up_m * ty, contact.up_m * tx, 0.0)
        self._derivative(force, normal_n * level / contact.around_m, motion)

    def _add_inside(self, fit: Fit, height_m: float, sunk_m: float, bristles: Bristles) -> None:
        """Contacts of a connector rub along its axis, with a force by the depth."""
        depths, forces = zip(*fit.contact_forces, strict=True)
        limit_n = float(np.interp(-height_m, depths, forces))
        trial = bristles.get(_INSIDE, (0.0, 0.0, 0.0))[2] + sunk_m
        kept = max(-_SPRING_GIVES_M, min(_SPRING_GIVES_M, trial))
        self._bristles[_INSIDE] = (0.0, 0.0, kept)
        axial = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
        self._force(-limit_n * kept / _SPRING_GIVES_M, axial)
        if kept == trial:
            self._derivative(axial, limit_n / _SPRING_GIVES_M, axial)


def _row(contact: Contact, x: float, y: float, z: float) -> Row:
    """A force of one newton at a contact, as a wrench about the tip."""
    lx, ly, lz = contact.lx, contact.ly, contact.lz
    return x, y, z, ly * z - lz * y, lz * x - lx * z, lx * y - ly * x


def _difference(a: Pose6, b: Pose6) -> Pose6:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3], a[4] - b[4], a[5] - b[5]


def _moved(pose: Pose6, step: Sequence[float]) -> Pose6:
    return (
        pose[0] + step[0], pose[1] + step[1], pose[2] + step[2],
        pose[3] + step[3], pose[4] + step[4], pose[5] + step[5],
    )  # fmt: skip
