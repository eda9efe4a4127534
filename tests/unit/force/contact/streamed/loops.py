"""The sampled loop of law, arm, contact and filter, run with the law itself."""

from dataclasses import dataclass, field

import numpy as np

from cellctl.force.contact.streamed.admittance import (
    Admittance,
    AdmittanceBounds,
    AdmittanceGains,
)
from cellctl.geometry.pose import Array

UNBOUNDED = AdmittanceBounds(np.full(6, 1e3), np.full(6, 1e9), np.full(6, 0.5))


@dataclass(eq=False)
class SampledLoop:
    """One contact of stiffness k along the weights w (6,), seen by arm and filter with delays."""

    stiffness_n_m: float
    weights: Array
    """Direction and lever of the contact, as they truly are; the law need not know them."""
    damping: Array
    period_s: float = 4e-3
    delay_ticks: int = 2
    arm_lag_s: float = 4e-3
    filter_s: float = 4e-3
    mass: Array = field(default_factory=lambda: np.array([5, 5, 5, 5e-4, 5e-4, 5e-4]))

    @property
    def dead_time_s(self) -> float:
        """θ = T (n_d + 1.5) + τ_r + τ_f."""
        return self.period_s * (self.delay_ticks + 1.5) + self.arm_lag_s + self.filter_s

    def force_n(self, push_n: float, ticks: int) -> Array:
        """Contact force (n,) after the filter, from the tick before a step of the push on."""
        state = np.zeros(12 + self.delay_ticks + 2)
        forces = [0.0]
        for _ in range(ticks):
            state = self._after(state, push_n)
            forces.append(float(state[-1]))
        return np.array(forces)

    def greatest_eigenvalue(self) -> float:
        """Absolute; the law is linear within its bounds, so unit vectors give the matrix."""
        scale = 1e-4  # rotations are small, as everywhere in the law
        unit = scale * np.eye(12 + self.delay_ticks + 2)
        matrix = np.stack([self._after(one, 0.0) / scale for one in unit], axis=1)
        return float(np.abs(np.linalg.eigvals(matrix)).max())

    def _after(self, state: Array, push_n: float) -> Array:
        """State of the next tick: displacement, velocity, ways under way, way of the arm, felt."""
        gains = AdmittanceGains(self.mass, self.damping, np.zeros(6), self.weights != 0)
        law = Admittance(gains, UNBOUNDED, self.period_s)
        # Where it stands is put there by a first move, its speed after it.
        law.velocity = state[:6] / self.period_s
        law.gains = AdmittanceGains(self.mass, np.zeros(6), np.zeros(6), self.weights != 0)
        law.step(np.zeros(6), np.zeros(6))
        law.gains, law.velocity = gains, state[6:12]
        felt_n = state[-1]
        moved = law.step(push_n * self.weights, -felt_n * self.weights)
        waiting = [*state[12:-2], float(self.weights @ moved)]
        arm_m, felt_n = self._follow(state[-2], felt_n, waiting[0])
        return np.array([*moved, *law.velocity, *waiting[1:], arm_m, felt_n])

    def _follow(self, arm_m: float, felt_n: float, target_m: float) -> tuple[float, float]:
        steps = 8
        step_s = self.period_s / steps
        for _ in range(steps):
            arm_m += (1 - np.exp(-step_s / self.arm_lag_s)) * (target_m - arm_m)
            force_n = self.stiffness_n_m * arm_m
            felt_n += (1 - np.exp(-step_s / self.filter_s)) * (force_n - felt_n)
        return arm_m, felt_n
