"""Forces of a plug that goes into its socket, against figures worked out beforehand.

The reference figures are those of a micro-D with 15 contacts.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cellctl.processes.antenna_module.connector.connector import read_connector
from fakes.world.connector.contact_lot import MatingPair, MatingSizes, Mount, draw_peaks
from fakes.world.connector.drawing import DRAWINGS, MICRO_D_15
from fakes.world.connector.insertion import (
    PinState,
    PlugPlace,
    Response,
    outside,
    pressed,
    respond,
)

CONNECTORS = Path("config/connectors")
HOLES = np.array(list(MICRO_D_15.positions_m("holes").values()))
PAIR = MatingPair(
    MatingSizes.of(MICRO_D_15), HOLES, HOLES, np.full(15, 1.6), np.ones(15), np.zeros(15)
)
BEFORE_SPRINGS = np.sort(np.append(np.linspace(0.0, 0.499e-3, 60)[1:], 0.2499e-3))
"""Depths with the very end of the funnel, where the axial force is highest."""
WHOLE_WAY = np.linspace(0.0, 2.49e-3, 250)[1:]


def pushed(
    pair: MatingPair, mount: Mount, place: PlugPlace, depths: np.ndarray = BEFORE_SPRINGS
) -> list[Response]:
    states, responses = outside(pair), []
    for depth in depths:
        response = respond(pair, mount, states, replace(place, depth_m=float(depth)))
        states = response.states
        responses.append(response)
    return responses


def most(responses: list[Response]) -> tuple[float, float, float]:
    """Axial, side, worst pin."""
    wrenches = np.array([response.wrench for response in responses])
    side = np.hypot(wrenches[:, 0], wrenches[:, 1]).max()
    worst = max(response.side_n.max() for response in responses)
    return float(wrenches[:, 2].max()), float(side), float(worst)


def bent(tips_m: dict[int, float]) -> MatingPair:
    pins = HOLES.copy()
    for index, bend_m in tips_m.items():
        pins[index, 0] += bend_m
    return replace(PAIR, pins_m=pins)


@pytest.mark.parametrize(
    ("error_mm", "lateral_n_mm", "axial_n", "side_n", "pin_n"),
    [
        (0.03, 200, 0.0, 0.0, 0.0),
        (0.05, 200, 3.8, 3.8, 0.25),
        (0.10, 200, 13.4, 13.1, 0.88),
        (0.19, 200, 30.6, 30.0, 2.0),
        (0.05, 50, 1.0, 1.0, 0.07),
        (0.10, 50, 3.5, 3.4, 0.23),
        (0.19, 50, 8.0, 7.9, 0.5),
        (0.05, 10, 0.2, 0.2, 0.01),
        (0.10, 10, 0.7, 0.7, 0.05),
        (0.19, 10, 1.6, 1.6, 0.1),
    ],
)
def test_offset(
    error_mm: float, lateral_n_mm: float, axial_n: float, side_n: float, pin_n: float
) -> None:
    mount = Mount(lateral_n_m=lateral_n_mm * 1e3)
    found = most(pushed(PAIR, mount, PlugPlace(x_m=error_mm * 1e-3)))
    assert found == pytest.approx((axial_n, side_n, pin_n), rel=0.03, abs=0.06)


def test_beyond_capture_all_pins_stand_on_the_face() -> None:
    responses = pushed(PAIR, Mount(), PlugPlace(x_m=0.25e-3), np.linspace(0.0, 0.04e-3, 9)[1:])
    assert (responses[-1].states == PinState.STANDING).all()
    assert responses[-1].wrench[2] == pytest.approx(90.0)


@pytest.mark.parametrize(
    ("yaw_deg", "lateral_n_mm", "pin_n", "moment_n_m"),
    [
        (0.5, 200, 1.5, 0.017),
        (1.0, 200, 7.2, 0.14),
        (0.5, 10, 0.4, 0.004),
        (1.0, 10, 1.8, 0.022),
        (2.0, 10, 3.8, 0.06),
    ],
)
def test_yaw(yaw_deg: float, lateral_n_mm: float, pin_n: float, moment_n_m: float) -> None:
    responses = pushed(PAIR, Mount(lateral_n_mm * 1e3), PlugPlace(yaw_rad=np.radians(yaw_deg)))
    assert most(responses)[2] == pytest.approx(pin_n, rel=0.06)
    moments = [abs(response.wrench[5]) for response in responses]
    assert max(moments) == pytest.approx(moment_n_m, rel=0.06)


def test_a_large_yaw_on_a_stiff_mount() -> None:
    """The reference stops at 15.5 N, shortly before the end of the funnel; the pin goes on."""
    responses = pushed(PAIR, Mount(2e5), PlugPlace(yaw_rad=np.radians(2.0)))
    at_funnel = [response.side_n.max() for response in responses if response.side_n.max() <= 15.6]
    assert max(at_funnel) > 14.0
    assert most(responses)[2] == pytest.approx(17.9, rel=0.02)


def test_nominal_peak_and_seat() -> None:
    responses = pushed(PAIR, Mount(), PlugPlace(), WHOLE_WAY)
    assert most(responses)[0] == pytest.approx(24.0, rel=0.02)
    assert responses[-1].wrench[2] == pytest.approx(0.7 * 24.0)
    seated = respond(PAIR, Mount(), responses[-1].states, PlugPlace(depth_m=2.6e-3))
    assert seated.wrench[2] - responses[-1].wrench[2] > 10.0


@pytest.mark.parametrize("name", list(DRAWINGS))
def test_springs_and_seat_lie_where_the_shipped_drawing_says(name: str) -> None:
    made, drawn = DRAWINGS[name], read_connector(CONNECTORS / f"{name}-holes.toml")
    holes = np.array(list(made.positions_m("holes").values()))
    np.testing.assert_allclose(holes, drawn.positions_m)
    peaks = np.full(len(holes), 1.6)
    pair = MatingPair(
        MatingSizes.of(made), holes, holes, peaks, np.ones(len(holes)), np.zeros(len(holes))
    )
    spring_m, seat_m = drawn.spring_depth_m, drawn.seat_depth_m
    depths = np.array([0.5 * spring_m, spring_m, spring_m + 0.4e-3, seat_m, seat_m + 0.1e-3])
    forces = [one.wrench[2] for one in pushed(pair, Mount(), PlugPlace(), depths)]
    sliding_n = 0.7 * peaks.sum()
    assert forces == pytest.approx([0.0, 0.0, peaks.sum(), sliding_n, sliding_n + 50.0])
    assert drawn.force_n[0] < peaks.sum() < drawn.force_n[1]


def test_tilt_lowers_the_peak_a_little_and_makes_a_small_moment() -> None:
    tilted = pushed(PAIR, Mount(), PlugPlace(tilt_rad=(0.0, np.radians(1.0))), WHOLE_WAY)
    assert most(tilted)[0] == pytest.approx(0.96 * 24.0, rel=0.02)
    moments = [np.abs(response.wrench[3:5]).max() for response in tilted]
    assert max(moments) == pytest.approx(0.012, rel=0.4)


def test_a_pin_bent_beyond_capture_stands_and_collapses() -> None:
    pair = bent({0: 0.30e-3})
    responses = pushed(pair, Mount(), PlugPlace(), np.linspace(0.0, 0.3e-3, 61)[1:])
    assert most(responses)[0] == pytest.approx(25.0, rel=0.05)
    assert responses[10].states[0] == PinState.STANDING
    assert responses[-1].states[0] == PinState.COLLAPSED
    assert (responses[-1].states[1:] == PinState.INSIDE).all()
    x, y = HOLES[0]
    standing = responses[10].wrench
    assert -standing[4] / standing[2] == pytest.approx(x + 0.3e-3, rel=0.02)
    assert standing[3] / standing[2] == pytest.approx(y, rel=0.02)


def test_a_missing_pin_shows_only_in_its_spring() -> None:
    present = np.ones(15)
    present[7] = 0.0
    pair = replace(PAIR, present=present)
    assert most(pushed(pair, Mount(), PlugPlace()))[0] == 0.0
    assert most(pushed(pair, Mount(), PlugPlace(), WHOLE_WAY))[0] == pytest.approx(
        24.0 * 14 / 15, rel=0.02
    )


def test_out_again_the_springs_pull_and_what_is_straight_is_outside() -> None:
    states = pushed(PAIR, Mount(), PlugPlace(), WHOLE_WAY)[-1].states
    pulled = respond(PAIR, Mount(), states, PlugPlace(depth_m=2.0e-3, inwards=False))
    assert pulled.wrench[2] == pytest.approx(-0.7 * 24.0)
    free = respond(PAIR, Mount(), states, PlugPlace(depth_m=-1e-3, inwards=False))
    assert (free.states == PinState.OUTSIDE).all()
    assert not free.wrench.any()


def test_the_axial_spring_shares_the_way() -> None:
    """One standing pin in series with the arm: 115 N/mm; all fifteen: 409 N/mm."""
    for pair, place, series_n_mm, rel in (
        (bent({0: 0.3e-3}), PlugPlace(), 115.0, 0.01),
        (PAIR, PlugPlace(x_m=0.25e-3), 409.0, 0.01),
    ):
        way_m = 0.05e-3
        _, response = pressed(pair, Mount(), outside(pair), replace(place, depth_m=way_m))
        assert response.wrench[2] == pytest.approx(series_n_mm * 1e3 * way_m, rel=rel)


def test_a_lot_differs_from_the_next_by_more_than_its_contacts() -> None:
    lots = [draw_peaks(np.random.default_rng(seed), 15) for seed in range(200)]
    means = np.array([lot.mean() for lot in lots])
    assert 0.35 < means.min() < 0.5
    assert 2.0 < means.max() < 2.5
    assert max(lot.max() / lot.min() for lot in lots) < 1.25 / 0.75
