"""Measures dead time and stiffness of a streamed contact on a fixture, and tries the loop.

Section 4.5 of the study of insertion by touch. What was found is an upper bound as long as robot,
controller version and tool stay the same.
"""

from dataclasses import dataclass

import numpy as np

from cellctl.cell.contact_motion.contact_loop import ContactLoop
from cellctl.cell.contact_motion.motions import ContactSample, Ended
from cellctl.cell.contact_motion.streamed_contact import StreamedContact
from cellctl.errors.streamed_contact import LoopFitRefused
from cellctl.force.contact.streamed.admittance import (
    Admittance,
    AdmittanceBounds,
    AdmittanceGains,
)
from cellctl.force.contact.streamed.gains import LoopFigures, damping, levers, virtual_mass
from cellctl.force.contact.streamed.identification import (
    FASTEST_CHIRP_HZ,
    TICKS_OF_THE_LOOP,
    StiffnessFit,
    burst_dead_times,
    check_loop,
    check_step,
    chirp,
    fit_loop,
    fit_stiffness,
)
from cellctl.force.contact.streamed.speeds import touch_speed_m_s
from cellctl.geometry.pose import Array

_DOWN = np.array([0.0, 0.0, 1.0])
_FORCES_N = (5.0, 10.0, 15.0, 20.0)
"""Forces at which the stiffness is read, upwards and then downwards (section 4.5, point 3)."""
_READ_S = 0.4
"""Length of a reading at standstill; its second half is averaged, 200 samples at 1 kHz."""
_CHIRP_S = 4.0
"""Length of a chirp. Without the ends over which it is faded, 3.2 s are left: six bursts of the
length that a dead time is fitted to, at ticks of 2 ms."""
_FREE_CHIRP_M = 1e-3
"""Amplitude in free air (section 4.5, point 1)."""
_SHARE_OF_STEP = 0.8
"""Share of the step that the controller accepts from tick to tick which a chirp may take. The rest
is for the rounding of poses; its exact value only makes the chirp a little smaller."""
_STEP_N = 5.0
"""Force before a step of the loop, and height of the step where speeds allow it (5 to 10 N in
section 4.5, point 4)."""
_STEPS = 8
"""Steps of which the mean is taken: it has about a third of the noise of one."""
_STEP_DEAD_TIMES = 12
"""Length of a step in dead times: twice the six after which it has to have settled."""
_ACCELERATION_M_S2 = 1.0
"""Acceleration of the steps of the loop. They are so short that the bound of ordinary motions would
hide how the loop behaves."""
_Z = 2


@dataclass(frozen=True, slots=True, eq=False)
class StepAnswer:
    """Mean answer of the loop to steps up of its push."""

    times_s: Array
    """Times since the step, shape (n,)."""
    rise_n: Array
    """Force above that before the step, shape (n,)."""
    step_n: float
    """Height of the step."""


@dataclass(frozen=True, slots=True, eq=False)
class CommissionedLoop:
    """What a commissioning has found."""

    figures: LoopFigures
    """The stiffness, and the greatest dead time of any burst."""
    usual_dead_time_s: float
    """Median of the dead times of all bursts."""
    motion_dead_time_s: float
    """From setpoint to measured pose in free air, median; the rest is that of the force."""
    stiffness: StiffnessFit
    fitted: LoopFigures
    """The same figures, fitted to the closed loop."""
    readings: Array
    """Travel in m and force in N at standstill, shape (n, 2)."""
    answer: StepAnswer
    """Answer of the loop to a step, with the gains that follow from ``figures``."""


async def commission_contact(
    loop: ContactLoop, travel_m: float, free_m: float = _FREE_CHIRP_M
) -> CommissionedLoop:
    """Chirp in free air, press on the fixture within ``travel_m`` along z, chirp and step there.

    The tip begins more than ``free_m`` above the fixture, the amplitude of the free chirp.

    ``loop.settings.figures`` are bounds that hold without any measurement; they make the first
    touch slow enough. Raises ``LoopFitRefused``, and what the motions raise.
    """
    run = _Commissioning(loop)
    motion_s = await run.motion_dead_times(min(free_m, run.greatest_chirp_m))
    stiffness, readings = await run.stiffness(travel_m)
    dead_s = await run.force_dead_times(stiffness.stiffness_n_m)
    figures = LoopFigures(stiffness.stiffness_n_m, float(dead_s.max()))
    usual = LoopFigures(stiffness.stiffness_n_m, float(np.median(dead_s)))
    fitted, answer = await run.loop_figures(figures, usual)
    await run.contact.back_out(loop.settings.follow_m)
    return CommissionedLoop(
        figures,
        usual.dead_time_s,
        float(np.median(motion_s)),
        stiffness,
        fitted,
        readings,
        answer,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Swing:
    """What was sent along z, when, and what followed; an entry for each of n setpoints.

    Pose, force and setpoint each have a time of their own: on a busy PC they are further apart than
    they need to be, and by a different amount at every tick.
    """

    samples: list[ContactSample]
    """The samples after each setpoint."""
    command_m: Array
    sent_s: Array
    force_s: Array
    """When the forces of the samples were measured."""
    used_s: Array
    """Age of the newest force that a setpoint could take into account, at the time it went out."""


class _Commissioning:
    def __init__(self, loop: ContactLoop) -> None:
        self._loop = loop
        self.contact = StreamedContact(loop)
        fastest_m_s = _SHARE_OF_STEP * loop.stream.limits.step_m / loop.period_s
        self.greatest_chirp_m = fastest_m_s / (2 * np.pi * FASTEST_CHIRP_HZ)

    async def motion_dead_times(self, amplitude_m: float) -> Array:
        swing = await self._chirp(amplitude_m)
        read_s = np.array([sample.time_s for sample in swing.samples])
        poses = np.array([sample.task_position_tip_m[_Z] for sample in swing.samples])
        return burst_dead_times(swing.sent_s, swing.command_m, read_s, poses)

    async def stiffness(self, travel_m: float) -> tuple[StiffnessFit, Array]:
        """The fit, and travel and force of each reading, shape (n, 2)."""
        readings = []
        for force_n in _FORCES_N:
            # Force that grows while the arm answers belongs to the next reading.
            touched = await self.contact.touch(_DOWN, travel_m, force_n)
            if touched.ended is not Ended.FORCE:
                raise LoopFitRefused(f"no {force_n:.0f} N within {travel_m * 1e3:.2f} mm")
            readings.append(await self._reading())
        # Downwards too: on the way up alone hysteresis would pass for a part of the slope.
        for _ in _FORCES_N[:-1]:
            slope = fit_stiffness(*np.array(readings).T).stiffness_n_m
            back_m = self._loop.tip_command[_Z] - _STEP_N / slope
            await self._go(back_m)
            readings.append(await self._reading())
        return fit_stiffness(*np.array(readings).T), np.array(readings)

    async def force_dead_times(self, stiffness_n_m: float) -> Array:
        """Dead times from setpoint to force, one for each burst of a chirp about 10 N.

        A sampled loop adds its own delay, because a setpoint is held for a tick.
        """
        _, felt_n = await self._reading()
        await self._go(self._loop.tip_command[_Z] + (2 * _STEP_N - felt_n) / stiffness_n_m)
        amplitude_m = min(_STEP_N / stiffness_n_m, self.greatest_chirp_m)
        swing = await self._chirp(amplitude_m)
        press_n = np.array([-sample.force_n[_Z] for sample in swing.samples])
        delays_s = burst_dead_times(
            swing.sent_s,
            swing.command_m * stiffness_n_m,
            swing.force_s,
            press_n,
            in_use_s=swing.used_s,
        )
        return np.asarray(delays_s + TICKS_OF_THE_LOOP * self._loop.period_s)

    async def loop_figures(
        self, figures: LoopFigures, usual: LoopFigures
    ) -> tuple[LoopFigures, StepAnswer]:
        """The figures that the closed loop shows, and its answer to a step with the designed
        gains."""
        # With twice the damping of the design no overshoot hides the figures (section 4.5, point
        # 4).
        slow = damping(figures, levers(self._loop.settings.lever_m), 2)
        answer = await self._steps(figures, slow)
        push_n = np.full(len(answer.times_s), answer.step_n)
        fitted = fit_loop(answer.times_s, push_n, answer.rise_n, float(slow[_Z]))
        # Held against the usual dead time, which a mean over steps shows. The gains are made for
        # the greatest one.
        check_loop(usual, fitted)
        designed = damping(figures, levers(self._loop.settings.lever_m), 1)
        answer = await self._steps(figures, designed)
        noise_n = float(self._loop.sample.force_sigma_n / np.sqrt(_STEPS))
        check_step(answer.times_s, answer.rise_n, answer.step_n, figures.dead_time_s, noise_n)
        return fitted, answer

    async def _steps(self, figures: LoopFigures, gains: Array) -> StepAnswer:
        """Mean answer over several steps of the push upwards."""
        speed_m_s = touch_speed_m_s(figures, self._loop.settings.press_n)
        # At the bound of the speed v the damper alone takes v S. A higher step would be held back
        # by that bound and say nothing about the loop; the remaining 20 % are room for the
        # overshoot.
        step_n = min(_STEP_N, 0.8 * speed_m_s * float(gains[_Z]))
        law = self._law(figures, gains, speed_m_s)
        nominal = self._loop.tip_command
        ticks = round(_STEP_DEAD_TIMES * figures.dead_time_s / self._loop.period_s)
        rises = []
        for _ in range(_STEPS):
            await self._push(law, nominal, _STEP_N, 2 * ticks)
            samples = await self._push(law, nominal, _STEP_N + step_n, ticks)
            rises.append([-sample.force_n[_Z] - _STEP_N for sample in samples])
        times_s = np.asarray(np.arange(ticks + 1) * self._loop.period_s, dtype=np.float64)
        return StepAnswer(times_s, np.asarray(np.mean(rises, axis=0)), step_n)

    async def _push(
        self, law: Admittance, nominal: Array, push_n: float, ticks: int
    ) -> list[ContactSample]:
        """The sample before, and one of each tick."""
        samples = [self._loop.sample]
        push = np.array([0.0, 0.0, push_n, 0.0, 0.0, 0.0])
        for _ in range(ticks):
            moved = law.step(push, self._loop.felt)
            samples.append(await self._loop.send(nominal + moved))
        return samples

    def _law(self, figures: LoopFigures, gains: Array, speed_m_s: float) -> Admittance:
        weights = levers(self._loop.settings.lever_m)
        only_z = np.arange(6) == _Z
        way_m = self._loop.settings.follow_m
        bounds = AdmittanceBounds(
            np.full(6, speed_m_s), np.full(6, _ACCELERATION_M_S2), np.full(6, way_m)
        )
        made = AdmittanceGains(virtual_mass(figures, weights), gains, np.zeros(6), only_z)
        return Admittance(made, bounds, self._loop.period_s)

    async def _chirp(self, amplitude_m: float) -> "_Swing":
        shifts = chirp(amplitude_m, _CHIRP_S, self._loop.period_s)
        begin, loop = self._loop.tip_command, self._loop
        times, samples = [], []
        for shift_m in shifts:
            known_s = loop.force_s
            samples.append(await loop.send(begin + shift_m * np.eye(6)[_Z]))
            times.append((loop.sent_s, loop.force_s, loop.sent_s - known_s))
        sent_s, force_s, used_s = np.array(times).T
        return _Swing(samples, np.asarray(begin[_Z] + shifts), sent_s, force_s, used_s)

    async def _reading(self) -> tuple[float, float]:
        """Travel and force along z at standstill: the second half of some ticks."""
        ticks = max(4, round(_READ_S / self._loop.period_s))
        samples = [await self._loop.send(self._loop.tip_command) for _ in range(ticks)]
        steady = samples[ticks // 2 :]
        travel_m = np.mean([sample.task_position_tip_m[_Z] for sample in steady])
        return float(travel_m), float(np.mean([-sample.force_n[_Z] for sample in steady]))

    async def _go(self, depth_m: float) -> None:
        """Along z in contact, as slowly as a touch."""
        way_m = float(depth_m - self._loop.tip_command[_Z])
        settings = self._loop.settings
        await self.contact.touch(
            np.sign(way_m) * _DOWN, abs(way_m), settings.limit_n, settings.touch_speed_m_s
        )
