"""Pins of the fake frame: wall, chamfer and top, against what springs and geometry say."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.faults import FaultBoard
from fakes.scenes.deck_on_frame.parts import draw_parts
from fakes.scenes.deck_on_frame.scenario import DeckScenario, Pins
from fakes.scenes.deck_on_frame.scene import FAULTS, deck_payload
from fakes.world.load.payload import Payload
from fakes.world.truth import draw

ARM_N_M = 1e6
PINS = Pins(
    length_mm=3.0,
    radius_mm=3.0,
    clearance_mm=0.05,
    chamfer_mm=1.0,
    chamfer_deg=30.0,
    stiffness_n_m=1e8,
)


def hanging(scenario: DeckScenario, friction: float = 0.0) -> Payload:
    """Deck and frame nominal, tool axes along those of the frame."""
    contact = scenario.contact.model_copy(update={"pins": PINS, "friction": friction})
    shaped = scenario.parts.model_copy(update={"hole_sigma_mm": 0.0})
    scenario = scenario.model_copy(update={"contact": contact, "parts": shaped})
    parts = replace(
        draw_parts(scenario, 1, 1),
        cell_T_frame=RigidTransform.identity(),
        flange_T_deck=RigidTransform.from_components(
            [0.0, 0.0, 0.5], Rotation.from_euler("x", 180, degrees=True)
        ),
        deck_thickness_m=0.015,
    )
    sensor = draw(scenario, 1).force_sensors["force"]
    return deck_payload(scenario, sensor, parts, FaultBoard("world", FAULTS), frame_present=True)


def at(x_mm: float, y_mm: float, height_mm: float, yaw_deg: float = 0.0) -> np.ndarray:
    """cell_T_flange with the deck's underside so high above the frame."""
    flange = np.eye(4)
    yaw = Rotation.from_euler("z", yaw_deg, degrees=True).as_matrix()
    flange[:3, :3] = yaw @ np.diag([1.0, -1.0, -1.0])
    flange[:3, 3] = np.array([x_mm, y_mm, height_mm + 515.0]) * 1e-3
    return flange


def settled(payload: Payload, flange: np.ndarray, steps: int = 3000) -> np.ndarray:
    """Spring force and torque on the centre of mass at rest, tool axes."""
    for _ in range(steps):
        payload.advance(flange.copy(), moving=True)
    return payload.suspension.spring_wrench


def push(payload: Payload, gaps: np.ndarray) -> np.ndarray:
    """Force of the pins on the deck without dampers, shape (3,), tool axes."""
    depths = np.maximum(payload.suspension._depths(gaps), 0.0)
    contacts = payload.suspension.contacts
    return np.asarray((contacts.stiffness_n_m * depths) @ contacts.jacobian[:, :3])


def contact_energy(payload: Payload, gaps: np.ndarray) -> float:
    """What the contacts store (J)."""
    suspension = payload.suspension
    springs = 0.5 * float(suspension.stiffness @ suspension.deflection**2)
    return suspension.energy(gaps) - springs


@pytest.mark.parametrize(
    "angle_deg",
    [11.25, *(pytest.param(one, marks=pytest.mark.figures) for one in (0.0, 45.0, 200.0))],
)
def test_the_wall_holds_what_lies_beyond_the_clearance(
    scenario: DeckScenario, angle_deg: float
) -> None:
    payload = hanging(scenario)
    along = np.array([np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))])
    x_mm, y_mm = 0.08 * along
    force = settled(payload, at(x_mm, y_mm, 1.0))[:3]
    expected_n = ARM_N_M * 0.03e-3
    assert force[:2] @ along == pytest.approx(-expected_n, rel=0.07)
    assert abs(force[2]) < 0.1
    assert abs(along[0] * force[1] - along[1] * force[0]) < 0.05 * expected_n


def test_within_the_clearance_nothing_is_felt(scenario: DeckScenario) -> None:
    payload = hanging(scenario)
    assert np.abs(settled(payload, at(0.03, -0.03, 0.5))).max() < 1e-6
    assert payload.peak_contact_force_n == 0.0


def test_a_turned_deck_is_turned_back_by_both_pins(scenario: DeckScenario) -> None:
    payload = hanging(scenario)
    yaw_deg = np.degrees(0.10e-3 / 0.5126)  # pins are 0.5126 m from the middle
    wrench = settled(payload, at(0.0, 0.0, 1.0, yaw_deg))
    assert wrench[5] < -2.0
    assert np.hypot(*wrench[:2]) < 3.0


def test_the_chamfer_pushes_up_and_in(scenario: DeckScenario) -> None:
    """Frictionless: the force stands on the cone, and gap and springs agree."""
    payload = hanging(scenario)
    force = settled(payload, at(0.3, 0.0, 2.3))[:3]
    slope = np.radians(PINS.chamfer_deg)
    assert force[0] / force[2] == pytest.approx(-np.cos(slope) / np.sin(slope), rel=0.01)
    depth_m = ((0.3 - 0.05) * np.cos(slope) - (2.3 - 2.0) * np.sin(slope)) * 1e-3
    assert np.linalg.norm(force) == pytest.approx(ARM_N_M * depth_m, rel=0.06)


def test_beyond_the_chamfer_the_deck_stands_on_the_pins(scenario: DeckScenario) -> None:
    payload = hanging(scenario)
    force = settled(payload, at(1.5, 0.0, 2.98))[:3]
    assert force[2] == pytest.approx(ARM_N_M * 0.02e-3, rel=0.06)
    assert np.hypot(*force[:2]) < 0.1


@pytest.mark.figures  # seconds of contact
def test_friction_holds_the_deck_back_on_its_way_in(scenario: DeckScenario) -> None:
    payload = hanging(scenario, friction=0.15)
    settled(payload, at(0.08, 0.0, 1.5))
    forces = []
    for step in range(2000):
        payload.advance(at(0.08, 0.0, 1.5 - 0.0005 * step), moving=True)
        forces.append(payload.suspension.spring_wrench[:3])
    sideways_n, up_n = np.mean(forces[1000:], axis=0)[[0, 2]]
    assert up_n == pytest.approx(0.15 * abs(sideways_n), rel=0.2)


@pytest.mark.parametrize(
    ("x_mm", "height_mm"), [(0.06, 1.0), (0.06, 2.02), (0.62, 3.005)], ids=["wall", "edge", "top"]
)
def test_free_motion_beside_a_pin_makes_no_energy(
    scenario: DeckScenario, x_mm: float, height_mm: float
) -> None:
    """Along the wall, over the chamfer onto the wall, and from the top onto the chamfer."""
    payload = hanging(scenario)
    flange = at(x_mm, 0.0, height_mm)
    payload.advance(flange, moving=False)
    payload.suspension.state[6:9] = [2e-3, 1e-3, -1e-3]
    gaps = payload._gaps_at(flange)
    energies = []
    for _ in range(400):
        payload.advance(flange.copy(), moving=True)
        energies.append(payload.suspension.energy(gaps))
    assert payload.peak_contact_force_n > 0.0
    assert max(energies[1:]) <= 1.05 * energies[0]
    assert energies[-1] < 0.9 * energies[0]


def test_the_forces_of_pins_come_from_an_energy_without_a_jump(scenario: DeckScenario) -> None:
    """Across every edge of chamfer, wall and top: what a small step gains or costs is its work."""
    payload = hanging(scenario)
    suspension = payload.suspension
    rng = np.random.default_rng(3)
    step_m, most_n = 2e-8, 0.0
    for _ in range(150):
        radius_mm, angle = rng.uniform(0.04, 0.9), rng.uniform(0.0, 2.0 * np.pi)
        suspension.state[:] = 0.0
        flange = at(radius_mm * np.cos(angle), radius_mm * np.sin(angle), rng.uniform(2.0, 3.0))
        gaps = payload._gaps_at(flange)
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        suspension.state[:3] = -20 * step_m * way
        before = contact_energy(payload, gaps)
        force = push(payload, gaps)
        for _ in range(40):
            suspension.state[:3] += step_m * way
            now, after = push(payload, gaps), contact_energy(payload, gaps)
            work = -0.5 * (force + now) @ way * step_m
            edge_n = float(np.linalg.norm(now - force))
            assert after - before == pytest.approx(work, abs=1.1 * edge_n * step_m + 1e-12)
            most_n = max(most_n, float(np.linalg.norm(now)))
            before, force = after, now
    assert most_n > 100.0


def test_the_top_of_a_pin_carries_once(scenario: DeckScenario) -> None:
    """However many directions overlap there: else a pin would be stiffer than it is."""
    payload = hanging(scenario.without_imperfections())
    settled(payload, at(1.5, 0.2, 2.98))
    pins = sum(hole.pin for hole in scenario.parts.holes)
    assert np.count_nonzero(payload.suspension.normal_forces) == pins


def test_a_deck_slips_in_its_grip_no_further_than_a_pin_lets_it(scenario: DeckScenario) -> None:
    payload = hanging(scenario)
    flange = at(0.048, 0.0, 1.0)
    payload.advance(flange, moving=False)
    assert payload.touch is not None
    deck = payload.touch.flange_T_body
    against, away = (
        RigidTransform.from_translation([x_mm * 1e-3, 0.0, 0.0]) * deck for x_mm in (0.005, -0.005)
    )
    assert not payload.regrip(against)
    payload.advance(flange.copy(), moving=True)
    assert payload.peak_contact_force_n == 0.0
    assert payload.regrip(away)
    assert payload.touch.flange_T_body == away
