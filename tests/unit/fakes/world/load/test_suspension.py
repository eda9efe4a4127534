"""The payload on its springs against closed forms."""

import numpy as np
import pytest

from fakes.scenario_file.sections import Springs
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.load.suspension import Contacts, Suspension
from tests.rigs.sweeps import sweep

STEP_S = 2.5e-4
MASS_KG = 200.0


def payload(scenario: DeckScenario, **changes: object) -> Springs:
    return scenario.payload.model_copy(update=changes)


def pads(stiffness_n_m: float, damping_n_s_m: float = 0.0) -> Contacts:
    """Four equal pads on the corners of a square about the centre of mass."""
    corners = np.array([[0.4, 0.2, -0.1], [0.4, -0.2, -0.1], [-0.4, 0.2, -0.1], [-0.4, -0.2, -0.1]])
    up = np.tile([0.0, 0.0, 1.0], (4, 1))
    jacobian = np.hstack([up, np.cross(corners, up)])
    return Contacts(jacobian, np.full(4, stiffness_n_m / 4), np.full(4, damping_n_s_m / 4))


@pytest.mark.parametrize("stiffness", [1e5, 1e6, 3e6, 1e7])
def test_impact_peak_is_v_times_root_k_m(scenario: DeckScenario, stiffness: float) -> None:
    """A free mass at v onto a spring: peak = v·sqrt(k·m)."""
    soft = payload(scenario, stiffness_n_m=(1e-3,) * 3, rotational_stiffness_nm_rad=(1e-3,) * 3)
    mass = Suspension(soft, MASS_KG, pads(stiffness))
    mass.state[8] = -1e-3
    peak = 0.0
    for _ in range(int(2 * np.pi / np.sqrt(stiffness / MASS_KG) / STEP_S)):
        mass.touch(STEP_S, np.zeros(4), np.zeros(4), np.zeros(6))
        peak = max(peak, mass.normal_forces.sum())
    assert peak == pytest.approx(1e-3 * np.sqrt(stiffness * MASS_KG), rel=0.01)


@pytest.mark.parametrize("stiffness", sweep((3e5, 3e6), (3e6,)))
def test_press_settles_at_springs_in_series(scenario: DeckScenario, stiffness: float) -> None:
    mass = Suspension(scenario.payload, MASS_KG, pads(stiffness, 2e3))
    depth = 50e-6
    for _ in range(int(6.0 / STEP_S)):
        mass.touch(STEP_S, np.full(4, -depth), np.zeros(4), np.zeros(6))
    robot = scenario.payload.stiffness_n_m[2]
    series = robot * stiffness / (robot + stiffness)
    assert mass.normal_forces.sum() == pytest.approx(series * depth, rel=1e-3)
    assert mass.spring_wrench[2] == pytest.approx(series * depth, rel=1e-3)


def test_free_oscillation_has_its_frequency_and_decay(scenario: DeckScenario) -> None:
    mass = Suspension(scenario.payload, MASS_KG, Contacts.none())
    mass.state[2] = 1e-4
    places = []
    for _ in range(1000):
        mass.free(1e-3, np.zeros(6))
        places.append(mass.deflection[2])
    natural = np.sqrt(scenario.payload.stiffness_n_m[2] / MASS_KG)
    zeta = scenario.payload.damping_ratio
    t = np.arange(1, 1001) * 1e-3
    damped = natural * np.sqrt(1 - zeta**2)
    swing = np.cos(damped * t) + zeta / np.sqrt(1 - zeta**2) * np.sin(damped * t)
    np.testing.assert_allclose(places, 1e-4 * np.exp(-zeta * natural * t) * swing, atol=1e-12)


@pytest.mark.parametrize("seed", sweep(range(6), (0, 1)))
def test_energy_never_grows(scenario: DeckScenario, seed: int) -> None:
    """Bouncing in all six directions on one-sided pads; a closing contact may cost 0.1 %."""
    rng = np.random.default_rng(seed)
    mass = Suspension(scenario.payload, MASS_KG, pads(rng.choice([1e6, 1e7]), 1e3))
    mass.state[6:9] = rng.normal(0, 2e-3, 3)
    mass.state[9:] = rng.normal(0, 5e-3, 3)
    gaps = np.zeros(4)
    first = last = mass.energy(gaps)
    touched = False
    for _ in range(8000):
        mass.touch(STEP_S, gaps, np.zeros(4), np.zeros(6))
        touched |= bool(mass.normal_forces.any())
        now = mass.energy(gaps)
        assert now <= last + 1e-3 * first
        last = now
    assert touched
    assert last < 0.05 * first


def test_contact_never_pulls(scenario: DeckScenario) -> None:
    mass = Suspension(scenario.payload, MASS_KG, pads(1e6, 5e4))
    mass.state[2], mass.state[8] = -1e-6, 0.05
    for _ in range(40):
        mass.touch(STEP_S, np.zeros(4), np.zeros(4), np.zeros(6))
        assert mass.normal_forces.min() >= 0


@pytest.mark.parametrize(
    ("speed_mm_s", "latency_s", "peak_n"),
    [
        (0.2, 0.002, 37), (0.2, 0.05, 44), (0.5, 0.002, 42), (0.5, 0.05, 58), (1, 0.002, 53),
        (1, 0.05, 84), (2, 0.002, 62), (2, 0.05, 132), (5, 0.002, 124), (5, 0.05, 297),
    ],
)  # fmt: skip
def test_stop_at_35_n_overshoots_as_an_independent_integrator_found(
    scenario: DeckScenario, speed_mm_s: float, latency_s: float, peak_n: float
) -> None:
    """200 kg behind 1e6 N/m onto 3e6 N/m, 5 ms low-pass, 35 N, then latency and 0.5 m/s²."""
    stiff = payload(scenario, damping_ratio=0.05)
    mass = Suspension(stiff, MASS_KG, pads(3e6, 2 * 0.05 * np.sqrt(3e6 * MASS_KG)))
    gap, rate, filtered, peak, braking_s = speed_mm_s * 5e-4, -speed_mm_s * 1e-3, 0.0, 0.0, np.inf
    for index in range(24_000):
        now_s = index * STEP_S
        braking = now_s > braking_s and rate < 0
        inertia = np.array([0, 0, -0.5 * MASS_KG if braking else 0, 0, 0, 0], dtype=float)
        rate = min(0.0, rate + 0.5 * STEP_S) if braking else rate
        mass.touch(STEP_S, np.full(4, gap), np.full(4, rate), inertia)
        gap += rate * STEP_S
        peak = max(peak, mass.normal_forces.sum())
        if index % 4 == 0:
            filtered += (mass.spring_wrench[2] - filtered) * (1 - np.exp(-0.2))
            if filtered > 35 and np.isinf(braking_s):
                braking_s = now_s + latency_s
        if now_s > braking_s + 0.3:
            break
    assert peak == pytest.approx(peak_n, rel=0.03)
