"""One insertion under the live watch: good pairs of many lots, and every fault that can be felt."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.connector.connector import Connector, read_connector
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve, InsertionSample
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits
from cellctl.processes.antenna_module.insertion.verdict import InsertionVerdict, judge_insertion
from cellctl.processes.antenna_module.insertion.watch import InsertionWatch
from fakes.world.connector.contact_lot import MatingPair, MatingSizes, Mount, draw_peaks
from fakes.world.connector.drawing import DRAWINGS, MICRO_D_15, ConnectorDrawing
from fakes.world.connector.insertion import (
    PinState,
    PlugPlace,
    Response,
    outside,
    pressed,
    respond,
)

RATE_HZ = 100.0
LATENCY_S = 0.25
START_M, BEYOND_SEAT_M = -0.3e-3, 0.3e-3
NEAR_SEAT_M = 0.5e-3
SEATED_N = 15.0
"""Above what sliding takes: there the drive ends."""
NOISE_N, NOISE_N_M = 0.05, 0.002
MEAN_OF = 3
TRUE_POSITION_M = 5e-6
"""Scatter of pins and of holes, per axis: with a play of 0.03 mm, contacts that scatter by twice as
much touch the walls even in a plug that is placed without any error."""


@dataclass(frozen=True, slots=True, eq=False)
class Kind:
    """Connectors of one kind, as the fake world makes them and as the cell has them drawn."""

    made: ConnectorDrawing
    drawn: Connector
    """The socket: the wrench is in its axes."""
    holes_m: Array
    limits: InsertionLimits

    @classmethod
    def of(cls, made: ConnectorDrawing) -> "Kind":
        """One kind of connector, with its shipped drawing."""
        drawn = read_connector(Path("config/connectors") / f"{made.name}-holes.toml")
        holes_m = np.array(list(made.positions_m("holes").values()))
        return cls(made, drawn, holes_m, InsertionLimits.of(drawn))


KINDS = {made.name: Kind.of(made) for made in DRAWINGS.values()}


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong with a pair; nothing by default."""

    name: str = "good"
    bend: float = 0.0
    """Bend of one pin, in any direction, relative to the capture radius of the connector."""
    offset: float = 0.0
    """Offset of the plug, in any direction, relative to the same."""
    yaw_deg: float = 0.0
    seat_early_m: float = 0.0
    missing: bool = False


GOOD = Fault()
FAULTS = (
    Fault("pin bent, 0.75 of the capture radius", bend=0.75),
    Fault("pin bent, 1.5", bend=1.5),
    Fault("offset 0.5", offset=0.5),
    Fault("offset 0.8", offset=0.8),
    Fault("offset 1.5", offset=1.5),
    Fault("yaw 1°", yaw_deg=1.0),
    Fault("seat 0.3 mm early", seat_early_m=0.3e-3),
)
"""A micro-D takes pins within 0.20 mm: bent by 0.15 and 0.30 mm, off by 0.10, 0.16 and 0.30 mm."""
MISSING = Fault("contact missing", missing=True)


@dataclass(frozen=True, slots=True)
class InsertionOutcome:
    """How one insertion ended."""

    connector: str
    fault: str
    caught: bool
    verdict: str
    side_n: float
    """Largest side force on one contact."""
    standing_n: float
    """Largest axial force on one contact that stands on the face."""
    total_n: float
    collapsed: bool
    travel_m: float
    """Way from the first early contact to where the plug stood; 0 without a trip in time."""


def run_insertion(
    fault: Fault, seed: int, *, in_steps: bool = False, name: str = MICRO_D_15.name
) -> InsertionOutcome:
    """Drive, watch, stop, judge.

    In steps of the entry the step under way is finished whatever the force: so it is driven where a
    stop request may be missed.
    """
    rng = np.random.default_rng([seed, int(in_steps)])
    kind = KINDS[name]
    limits = kind.limits
    pair, place = _draw(kind, fault, rng)
    drive = _Drive(pair, place, rng)
    watch = InsertionWatch(limits, MEAN_OF)
    stop_at = np.inf
    t_s, driven_m = 0.0, START_M
    while driven_m < kind.made.seat_m + BEYOND_SEAT_M:
        sample = drive.sample(t_s, driven_m)
        speed_m_s = limits.at(driven_m).speed_m_s
        if stop_at == np.inf and watch.feed(sample) is not None:
            stop_at = t_s + (
                _rest_of_step_s(driven_m, speed_m_s, limits.entry_step_m) if in_steps else LATENCY_S
            )
        near_seat = sample.depth_m > kind.made.seat_m - NEAR_SEAT_M
        seated = near_seat and sample.axial_n > drive.sliding_n + SEATED_N
        if t_s >= stop_at or seated:
            break
        t_s, driven_m = t_s + 1 / RATE_HZ, driven_m + speed_m_s / RATE_HZ
    curve = drive.curve()
    verdict = judge_insertion(curve, kind.drawn).verdict
    stopped = watch.trip is not None
    return InsertionOutcome(
        connector=name,
        fault=fault.name,
        caught=stopped or verdict is not InsertionVerdict.SEATED,
        verdict=verdict.value,
        side_n=drive.side_n,
        standing_n=drive.standing_n,
        total_n=drive.total_n,
        collapsed=drive.collapsed,
        travel_m=drive.travel_m if stopped else 0.0,
    )


def _rest_of_step_s(driven_m: float, speed_m_s: float, step_m: float) -> float:
    """Time until the step under way is finished, whatever is asked for meanwhile."""
    done_m = driven_m - START_M
    return float((np.ceil(done_m / step_m) * step_m - done_m) / speed_m_s)


def _draw(kind: Kind, fault: Fault, rng: np.random.Generator) -> tuple[MatingPair, PlugPlace]:
    """Placed as well as the chain places plugs, with pins as straight as good ones are."""
    sizes = MatingSizes.of(kind.made)
    sizes = replace(sizes, seat_m=sizes.seat_m - fault.seat_early_m)
    pins = kind.holes_m + rng.normal(0, TRUE_POSITION_M, kind.holes_m.shape)
    holes = kind.holes_m + rng.normal(0, TRUE_POSITION_M, kind.holes_m.shape)
    present = np.ones(len(pins))
    which = int(rng.integers(len(pins)))
    pins[which] += fault.bend * sizes.capture_m * _direction(rng)
    present[which] = 0.0 if fault.missing else 1.0
    pair = MatingPair(sizes, pins, holes, draw_peaks(rng, len(pins)), present, np.zeros(len(pins)))
    x, y = rng.normal(0, 13e-6, 2) + fault.offset * sizes.capture_m * _direction(rng)
    yaw = np.radians(rng.normal(0, 0.03) + fault.yaw_deg * rng.choice([-1, 1]))
    tilt = np.radians(rng.normal(0, 0.15, 2))
    return pair, PlugPlace(float(x), float(y), float(yaw), (float(tilt[0]), float(tilt[1])))


def _direction(rng: np.random.Generator) -> Array:
    angle = rng.uniform(0, 2 * np.pi)
    return np.array([np.cos(angle), np.sin(angle)])


class _Drive:
    """The far end of the axial spring moves; what contacts feel is kept."""

    def __init__(self, pair: MatingPair, place: PlugPlace, rng: np.random.Generator) -> None:
        self._pair, self._place, self._rng = pair, place, rng
        self._mount = Mount()
        self._states = outside(pair)
        self._samples: list[InsertionSample] = []
        self._last_n = 0.0
        self._first_m: float | None = None
        self.side_n = self.standing_n = self.total_n = 0.0
        self.sliding_n = float(pair.sizes.sliding_share * pair.peaks_n.sum())

    def sample(self, t_s: float, driven_m: float) -> InsertionSample:
        depth_m, response = self._settle(driven_m)
        wrench = response.wrench
        self._states, self._last_n = response.states, float(wrench[2])
        self.side_n = max(self.side_n, float(response.side_n.max()))
        stands = response.states == PinState.STANDING
        self.standing_n = max(self.standing_n, float((response.axial_n * stands).max()))
        self.total_n = max(self.total_n, float(wrench[2]))
        if self._first_m is None and np.abs(wrench[:3]).max() > NOISE_N:
            self._first_m = depth_m
        force = wrench[:3] + self._rng.normal(0, NOISE_N, 3)
        moment = wrench[3:] + self._rng.normal(0, NOISE_N_M, 3)
        sample = InsertionSample(t_s, depth_m, force, moment)
        self._samples.append(sample)
        return sample

    def _settle(self, driven_m: float) -> tuple[float, Response]:
        depth_m = driven_m - self._last_n / self._mount.axial_n_m
        place = replace(self._place, depth_m=depth_m)
        response = respond(self._pair, self._mount, self._states, place)
        hard = (response.states == PinState.STANDING).any() or depth_m > self._pair.sizes.seat_m
        if not hard:
            return depth_m, response
        # Face and seat are stiffer than the spring, so the place is found by bisection there.
        there = replace(self._place, depth_m=driven_m)
        return pressed(self._pair, self._mount, self._states, there)

    @property
    def collapsed(self) -> bool:
        return bool((self._states == PinState.COLLAPSED).any())

    @property
    def travel_m(self) -> float:
        if self._first_m is None:
            return 0.0
        return self._samples[-1].depth_m - self._first_m

    def curve(self) -> InsertionCurve:
        samples = self._samples
        return InsertionCurve(
            np.array([one.t_s for one in samples]),
            np.array([one.depth_m for one in samples]),
            np.stack([one.force_n for one in samples]),
            np.stack([one.moment_n_m for one in samples]),
        )
