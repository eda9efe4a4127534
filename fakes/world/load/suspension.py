"""What hangs from a flange as one mass on springs, and what it touches.

State: deflection of the centre of mass from where the flange would carry it, and its rate, each
x, y, z (m) and rotation vector (rad) in tool axes. Contacts are one-sided springs with dampers in
given directions, unless they hold. With the set of closed contacts constant over a substep the
motion is linear, so each set has its own exact propagator: stable at any stiffness, and no energy
is made.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import expm

from fakes.scenario_file.sections import Springs
from fakes.world.frames import Array

Rows = np.ndarray[tuple[int, int], np.dtype[np.intp]]
Wedges = np.ndarray[tuple[int, int, int], np.dtype[np.intp]]
Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Possible contact points: Jacobian rows (n, 6) of their gaps, stiffness and damping (n,)."""

    jacobian: Array
    stiffness_n_m: Array
    damping_n_s_m: Array
    wedges: Wedges = field(default_factory=lambda: np.zeros((0, 0, 3), dtype=np.intp))
    """Shape (m, d, 3): rows of the two side faces and the top of m obstacles in d directions."""
    holding: Flags | None = None
    """Shape (n,): rows that pull as well once they were closed, until nothing is in reach."""

    @classmethod
    def none(cls) -> "Contacts":
        """Nothing to touch."""
        return cls(np.zeros((0, 6)), np.zeros(0), np.zeros(0))


class Suspension:
    """Integrates the payload between two times of the world's clock."""

    def __init__(self, springs: Springs, mass_kg: float, contacts: Contacts) -> None:
        self.mass = np.array([mass_kg] * 3 + list(springs.inertia_kg_m2))
        self.stiffness = np.array(
            [*springs.stiffness_n_m, *springs.rotational_stiffness_nm_rad], dtype=float
        )
        self.damping = 2 * springs.damping_ratio * np.sqrt(self.stiffness * self.mass)
        self.contacts = contacts
        self.state = np.zeros(12)
        self.normal_forces = np.zeros(len(contacts.stiffness_n_m))
        """Normal force of every row (N), negative where it pulls."""
        self._held = np.zeros(len(contacts.stiffness_n_m), dtype=bool)
        self._propagators: dict[tuple[bytes, float], tuple[Array, Array]] = {}

    @property
    def deflection(self) -> Array:
        """Displacement of the payload in tool axes, shape (6,)."""
        return self.state[:6]

    @property
    def rate(self) -> Array:
        """Rate of change of the place, shape (6,)."""
        return self.state[6:]

    @property
    def spring_wrench(self) -> Array:
        """Load of the payload on the sensor without gravity, about the centre of mass (N, N·m)."""
        return np.asarray(self.stiffness * self.state[:6] + self.damping * self.state[6:])

    def energy(self, gaps: Array) -> float:
        """Kinetic and elastic energy with the flange at rest (J)."""
        reach = np.maximum(self._depths(gaps), 0.0)
        elastic = self.stiffness @ self.deflection**2 + self.contacts.stiffness_n_m @ reach**2
        return float(0.5 * (elastic + self.mass @ self.rate**2))

    def closes(self, gaps: Array) -> bool:
        """True where a contact would be closed at these gaps and the present deflection."""
        return bool((self._depths(gaps) > 0).any())

    def free(self, step_s: float, wrench: Array) -> None:
        """Advance with nothing in reach; what was held is free again."""
        self._held[:] = False
        transition, response = self._propagator(None, step_s)
        self.state = transition @ self.state + response @ wrench

    def touch(
        self,
        step_s: float,
        gaps: Array,
        gap_rates: Array,
        wrench: Array,
        *,
        goes_on: bool = False,
    ) -> None:
        """Advance with contacts in reach; ``gaps`` at the start, without deflection.

        ``goes_on``: the gaps begin where they ended in the call before, at the same rates. The
        forces at the start are then known already.
        """
        contacts = self.contacts
        forces = self.normal_forces if goes_on else self._forces(gaps, gap_rates)
        closed = forces != 0
        middle = gaps + 0.5 * step_s * gap_rates
        push = contacts.stiffness_n_m * middle + contacts.damping_n_s_m * gap_rates
        wrench = wrench - (push * closed) @ contacts.jacobian
        transition, response = self._propagator(closed, step_s)
        self.state = transition @ self.state + response @ wrench
        self.normal_forces = self._forces(gaps + step_s * gap_rates, gap_rates)

    def _forces(self, gaps: Array, gap_rates: Array) -> Array:
        """Normal forces: closed contacts push, and pull only where they hold."""
        contacts = self.contacts
        depth = self._depths(gaps)
        approach = gap_rates + contacts.jacobian @ self.rate
        force = contacts.stiffness_n_m * depth - contacts.damping_n_s_m * approach
        pushing = np.maximum(force, 0.0) * (depth > 0)
        if contacts.holding is None:
            return np.asarray(pushing)
        self._held |= contacts.holding & (depth > 0)
        return np.where(self._held, force, pushing)

    def _depths(self, gaps: Array) -> Array:
        """How deep each row is closed; negative for an open one."""
        depths = -(gaps + self.contacts.jacobian @ self.deflection)
        wedges = self.contacts.wedges
        if not len(wedges):
            return np.asarray(depths)
        faces = depths[wedges]
        depths[wedges] = -1.0
        # Rarely is an obstacle entered, and the search for its nearest faces is slow.
        for index in np.flatnonzero((faces.min(axis=2) > 0).any(axis=1)):
            _push_out(depths, wedges[index], faces[index])
        return np.asarray(depths)

    def _propagator(self, closed: Flags | None, step_s: float) -> tuple[Array, Array]:
        key = (b"" if closed is None or not closed.any() else closed.tobytes(), step_s)
        if key not in self._propagators:
            stiffness, damping = np.diag(self.stiffness), np.diag(self.damping)
            if key[0]:
                rows = self.contacts.jacobian[closed]
                stiffness = stiffness + rows.T * self.contacts.stiffness_n_m[closed] @ rows
                damping = damping + rows.T * self.contacts.damping_n_s_m[closed] @ rows
            system = np.zeros((18, 18))
            system[:6, 6:12] = np.eye(6)
            system[6:12, :6] = -stiffness / self.mass[:, np.newaxis]
            system[6:12, 6:12] = -damping / self.mass[:, np.newaxis]
            system[6:12, 12:] = np.diag(1 / self.mass)
            exact = expm(system * step_s)
            self._propagators[key] = (exact[:12, :12], exact[:12, 12:])
        return self._propagators[key]


def _push_out(depths: Array, rows: Rows, faces: Array) -> None:
    """Close the rows that push out of one obstacle; ``rows`` and their depths (m) are (d, 3).

    In each direction the nearer side face pushes, or the top in place of all of them: once, because
    the directions share it. It is what costs less energy, so no edge makes any.
    """
    sides = faces[:, :2]
    reach = np.maximum(sides.min(axis=1), 0.0)
    deepest = reach.argmax()
    top = faces[deepest, 2]
    if max(top, 0.0) ** 2 < reach @ reach:
        depths[rows[deepest, 2]] = top
    else:
        depths[rows[np.arange(len(rows)), sides.argmin(axis=1)]] = reach
