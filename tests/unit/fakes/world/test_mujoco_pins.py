"""A dowel that sits on its chamfer: force without a seat, in the fake as in MuJoCo.

MuJoCo's pins and holes are convex meshes (64 and 32 sectors, chamfers on both) that share nothing
with the fake's faces. The deck is lowered beside its place until the springs carry the target
force or it is down; then both are judged like a mating.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from cellctl.force.contact.seat import SeatFinding, SeatVerdict, judge_seat, seat_limits
from fakes.scenes.deck_on_frame.scenario import Pins
from fakes.world.load.payload import STEP_S
from tests.unit.fakes.world.mujoco_rig import (
    DT_S,
    MASS_KG,
    RADIUS_M,
    Oracle,
    Rig,
    carry,
    mujoco,
    rig,
)

CONTACT_N_M = 3e6
SPEED_M_S = 5e-4
TARGET_N = 36.0
SETTLE_S = 0.3
PIN_CHAMFER_MM, HOLE_CHAMFER_MM = 1.5, 0.5
PINS = Pins(
    length_mm=3.5,
    radius_mm=3.0,
    clearance_mm=0.05,
    chamfer_mm=PIN_CHAMFER_MM + HOLE_CHAMFER_MM,
    chamfer_deg=45.0,
    stiffness_n_m=2e7,
)
ABOVE_M = 4e-3
"""Height of the deck above its seat at the beginning."""
LIMITS = seat_limits(
    target_force_n=35.0, abort_force_n=45.0, max_lateral_n=25.0, half_size_m=(0.5, 0.25)
)
SPRINGS = np.array([1e6, 1e6, 1e6, 4e5, 4e5, 3e5])


@pytest.fixture(autouse=True)
def _no_log_in_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MuJoCo drops MUJOCO_LOG.TXT where it runs."""
    monkeypatch.chdir(tmp_path)


@dataclass(frozen=True)
class Rest:
    """Where the flange stands when the force is reached, and what bends there."""

    way_m: float
    deflection: np.ndarray
    """Deflection of the centre of mass, shape (6,), world axes."""

    def verdict(self, rig: Rig) -> SeatVerdict:
        force, torque = np.split(SPRINGS * self.deflection, 2)
        torque = torque - np.cross(rig.com_T_deck.translation, force)
        series = 1.0 / (1.0 / CONTACT_N_M + 1e-6)
        return judge_seat(
            np.concatenate([force, torque]),
            travel_m=self.way_m,
            expected_m=ABOVE_M,
            stiffness_n_m=series,
            limits=LIMITS,
        )


def pinned() -> Rig:
    plain = rig(CONTACT_N_M)
    contact = plain.scenario.contact.model_copy(update={"pins": PINS})
    parts = plain.scenario.parts.model_copy(update={"hole_sigma_mm": 0.0})
    scenario = plain.scenario.model_copy(update={"contact": contact, "parts": parts})
    return Rig(scenario, plain.contact_n_m, plain.tilt)


def lowered_in_the_fake(rig: Rig, offset_m: float) -> Rest:
    payload = rig.payload()
    assert payload.touch is not None
    start = np.eye(4)
    start[:3, :3] = np.diag([1.0, -1.0, -1.0])
    deck_in_flange = payload.touch.flange_T_body.translation
    start[:3, 3] = [offset_m, 0.0, ABOVE_M + 0.015 + deck_in_flange[2]]
    payload.advance(start, moving=False)
    way_m, standing_s = 0.0, 0.0
    while standing_s < SETTLE_S:
        if _pressed(payload.suspension.deflection) or standing_s > 0.0:
            standing_s += STEP_S
        else:
            way_m += SPEED_M_S * STEP_S
        flange = start.copy()
        flange[2, 3] -= way_m
        payload.advance(flange, moving=True)
    return Rest(way_m, payload.suspension.deflection.copy())


def _pressed(deflection: np.ndarray) -> bool:
    return bool(SPRINGS[2] * deflection[2] >= TARGET_N)


class PinOracle(Oracle):
    """An oracle with pins on the frame, shifted, and rings of sectors as holes of the deck."""

    def __init__(self, rig: Rig, offset_m: float) -> None:
        super().__init__(rig)
        # The pads are balls below the deck, so that the seated deck is their radius up.
        places = [hole.position_mm for hole in rig.scenario.parts.holes if hole.pin]
        parameter = PINS.stiffness_n_m / MASS_KG
        stiff = f'solref="-{parameter:.9g} -{0.2 * np.sqrt(parameter):.9g}"'
        frame, deck = [], []
        for x_mm, y_mm in places:
            x, y, z = rig.com_T_deck.apply([x_mm * 1e-3, y_mm * 1e-3, -0.015])
            at = f"{x - offset_m:.9g} {y:.9g} {RADIUS_M}"
            frame.append(f'<geom type="mesh" mesh="pin" pos="{at}" {stiff} {_TOUCHES_HOLES}/>')
            deck += [
                f'<geom type="mesh" mesh="s{n}" pos="{x:.9g} {y:.9g} {z:.9g}" mass="0" '
                f"{stiff} {_TOUCHES_PINS}/>"
                for n in range(_SECTORS)
            ]
        self.on_the_frame, self.on_the_deck = "".join(frame), "".join(deck)
        meshes = {"pin": _pin_points()} | {f"s{n}": _sector_points(n) for n in range(_SECTORS)}
        self.assets = "".join(_mesh(name, points) for name, points in meshes.items())

    def lowered(self) -> Rest:
        model, data = self.build(self.parameter, ABOVE_M)
        assert model.ngeom > 2 * _SECTORS
        way_m, standing_s = 0.0, 0.0
        while standing_s < SETTLE_S:
            stopped = _pressed(data.qpos[1:7]) or standing_s > 0.0
            standing_s += DT_S * stopped
            way_m += SPEED_M_S * DT_S * (not stopped)
            carry(data, -way_m, -SPEED_M_S * (not stopped))
            mujoco.mj_step(model, data)
        return Rest(way_m, np.array(data.qpos[1:7]))


_SECTORS = 32
_TOUCHES_HOLES = 'contype="2" conaffinity="4"'
_TOUCHES_PINS = 'contype="4" conaffinity="2"'


def _pin_points() -> np.ndarray:
    angles = 2 * np.pi * np.arange(2 * _SECTORS) / (2 * _SECTORS)
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    radius, tip = PINS.radius_mm, PINS.radius_mm - PIN_CHAMFER_MM
    shoulder = PINS.length_mm - PIN_CHAMFER_MM
    rings = ((radius, 0.0), (radius, shoulder), (tip, PINS.length_mm))
    return np.vstack([np.column_stack([r * ring, np.full(len(ring), z)]) for r, z in rings]) * 1e-3


def _sector_points(number: int) -> np.ndarray:
    """A wedge of the wall whose flat inner side stands at the bore's radius."""
    half = np.pi / _SECTORS
    bore = PINS.radius_mm + PINS.clearance_mm
    outline = ((bore + HOLE_CHAMFER_MM, 0.0), (8.0, 0.0), (8.0, 10.0), (bore, 10.0),
               (bore, HOLE_CHAMFER_MM))  # fmt: skip
    return (
        np.array(
            [
                [r / np.cos(half) * np.cos(angle), r / np.cos(half) * np.sin(angle), z]
                for angle in (2 * half * number - half, 2 * half * number + half)
                for r, z in outline
            ]
        )
        * 1e-3
    )


def _mesh(name: str, points: np.ndarray) -> str:
    text = " ".join(f"{value:.9g}" for value in points.ravel())
    return f'<mesh name="{name}" vertex="{text}"/>'


@pytest.mark.figures  # seconds of contact; `test_mujoco_contact.py` compares one
@pytest.mark.parametrize(
    ("offset_mm", "findings"),
    [
        pytest.param(0.03, (), marks=pytest.mark.long),
        pytest.param(0.08, (SeatFinding.LATERAL,), marks=pytest.mark.long),
        (0.12, (SeatFinding.HIGH, SeatFinding.LATERAL)),
    ],
)
def test_the_seat_is_judged_alike(offset_mm: float, findings: tuple[SeatFinding, ...]) -> None:
    """The deck is within the clearance, beyond it but on the seat, or caught by the chamfer."""
    here = pinned()
    fake = lowered_in_the_fake(here, offset_mm * 1e-3).verdict(here)
    independent = PinOracle(here, offset_mm * 1e-3).lowered().verdict(here)
    assert fake.findings == independent.findings == findings
    assert fake.force_n == pytest.approx(independent.force_n, rel=0.02)
    assert fake.lateral_n == pytest.approx(independent.lateral_n, rel=0.05, abs=0.5)
    assert fake.gap_m == pytest.approx(independent.gap_m, abs=1e-5)
