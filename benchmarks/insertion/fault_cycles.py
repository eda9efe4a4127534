"""Whole cycles with one fault of the study's table of signatures (R5)."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from enum import StrEnum

import numpy as np

from benchmarks.insertion.contact_guard import SensorFault
from benchmarks.insertion.contact_world import Injected
from benchmarks.insertion.cycles import CycleCell, CycleInjection
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from fakes.scenes.socket.part import draw_part, nominal_fit
from fakes.world.frames import Array, displacement
from fakes.world.peg.fit import Burr, Fit

_FORCE_SIGMA = np.array([0.1, 0.1, 0.1, 0.003, 0.003, 0.003])


class CycleFault(StrEnum):
    """What is wrong with a cycle. Stream, stop and face are lost in the tests over the wire."""

    HOLE_ABSENT = "no hole"
    BLOCKED = "blocked hole"
    BURR = "burr in the bore"
    WRONG_SIZE = "bore too narrow"
    WRONG_HOLE = "bore too wide"
    PEG_SLIP = "part slips in the gripper"
    TILTED_GRIP = "part gripped at an angle"
    FROZEN = "sensor repeats itself"
    STUCK = "sensor stays, with noise"
    SPIKES = "spikes of the sensor"
    SIGN = "force with the wrong sign"


EXPECTED: Mapping[CycleFault, frozenset[str]] = {
    CycleFault.HOLE_ABSENT: frozenset({"F547", "F548"}),
    CycleFault.BLOCKED: frozenset({"F554", "F592"}),
    CycleFault.BURR: frozenset({"F552", "F554", "F592"}),
    # A peg that is too thick stands on the chamfer: to the search that is no hole.
    CycleFault.WRONG_SIZE: frozenset({"F547", "F548", "F554", "F598"}),
    CycleFault.WRONG_HOLE: frozenset({"F593", "F594", "F598"}),
    CycleFault.PEG_SLIP: frozenset({"F591", "F592", "F593"}),
    CycleFault.TILTED_GRIP: frozenset({"F552", "F553"}),
    CycleFault.FROZEN: frozenset({"F504"}),
    # A value at which it stays on the way is a force that holds the part back.
    CycleFault.STUCK: frozenset({"F590", "F591", "F592", "F593"}),
    CycleFault.SPIKES: frozenset({"F512"}),
    CycleFault.SIGN: frozenset({"F512", "F549", "F587", "F588", "F548", "F547"}),
}
"""The right ones. A cycle that overcomes a burr or an angle is right too."""


def injected(cell: CycleCell, fault: CycleFault, seed: int) -> CycleInjection:
    """The same seed makes the same fault."""
    rng = np.random.default_rng([seed, list(CycleFault).index(fault)])
    return _MAKE[fault](cell, seed, rng)


_Make = Callable[[CycleCell, int, np.random.Generator], CycleInjection]


def _shaped(change: Callable[[Fit, np.random.Generator], Fit]) -> _Make:
    def make(cell: CycleCell, _seed: int, rng: np.random.Generator) -> CycleInjection:
        return CycleInjection(Injected(fit=change(nominal_fit(cell.scenario.fit), rng)))

    return make


def _narrower(fit: Fit, rng: np.random.Generator) -> Fit:
    by_m = fit.clearance_m + float(rng.uniform(0.02e-3, 0.2e-3))
    return replace(fit, bore_radius_m=fit.bore_radius_m - by_m)


def _wider(fit: Fit, rng: np.random.Generator) -> Fit:
    return replace(fit, bore_radius_m=fit.bore_radius_m + float(rng.uniform(0.12e-3, 0.3e-3)))


def _blocked(fit: Fit, rng: np.random.Generator) -> Fit:
    return replace(fit, depth_m=fit.depth_m * float(rng.uniform(0.3, 0.9)))


def _burr(fit: Fit, rng: np.random.Generator) -> Fit:
    depth_m = fit.depth_m * float(rng.uniform(0.3, 0.8))
    height_m = fit.clearance_m * float(rng.uniform(2.2, 5.0))
    return replace(fit, burr=Burr(depth_m, height_m, float(rng.uniform(-np.pi, np.pi))))


def _slips(_cell: CycleCell, _seed: int, rng: np.random.Generator) -> CycleInjection:
    return CycleInjection(Injected(grip_n=float(rng.uniform(4.0, 15.0))))


def _tilted(cell: CycleCell, seed: int, rng: np.random.Generator) -> CycleInjection:
    part = draw_part(cell.scenario, seed, 1)
    azimuth, tilt = float(rng.uniform(-np.pi, np.pi)), np.radians(float(rng.uniform(2.0, 4.0)))
    turn = displacement([0, 0, 0], [tilt * np.cos(azimuth), tilt * np.sin(azimuth), 0.0])
    return CycleInjection(part=replace(part, flange_T_peg=part.flange_T_peg * turn))


def _sensor(
    told: Callable[[np.random.Generator], Callable[[Array, Array], Array]], phase: CyclePhase
) -> _Make:
    def make(_cell: CycleCell, _seed: int, rng: np.random.Generator) -> CycleInjection:
        fault = SensorFault(told(rng))
        return CycleInjection(
            Injected(sensor=fault), sensor_from=phase, sensor_delay_s=float(rng.uniform(0.5, 4.0))
        )

    return make


def _spiky(rng: np.random.Generator) -> Callable[[Array, Array], Array]:
    def told(sample: Array, _last: Array) -> Array:
        # Two in a hundred samples, far beyond every limit.
        spike = rng.random() < 0.02
        return sample + 200.0 * rng.normal(0.0, 1.0, 6) if spike else sample

    return told


_MAKE: Mapping[CycleFault, _Make] = {
    CycleFault.HOLE_ABSENT: _shaped(lambda fit, _rng: replace(fit, hole_present=False)),
    CycleFault.BLOCKED: _shaped(_blocked),
    CycleFault.BURR: _shaped(_burr),
    CycleFault.WRONG_SIZE: _shaped(_narrower),
    CycleFault.WRONG_HOLE: _shaped(_wider),
    CycleFault.PEG_SLIP: _slips,
    CycleFault.TILTED_GRIP: _tilted,
    CycleFault.FROZEN: _sensor(lambda _rng: lambda _sample, last: last, CyclePhase.INSERTION),
    CycleFault.STUCK: _sensor(
        lambda rng: lambda _sample, last: last + rng.normal(0.0, _FORCE_SIGMA),
        CyclePhase.INSERTION,
    ),
    CycleFault.SPIKES: _sensor(_spiky, CyclePhase.INSERTION),
    CycleFault.SIGN: _sensor(lambda _rng: lambda sample, _last: -sample, CyclePhase.FACE),
}
