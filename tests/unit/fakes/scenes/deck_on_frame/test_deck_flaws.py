"""Slip in the grip and burrs: as large as the catalogue says, and only where they may be."""

from itertools import islice

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenes.deck_on_frame.flex import deck_T_tangent, hang_m
from fakes.scenes.deck_on_frame.parts import draw_parts, grip_slips
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.frames import distance
from tests.unit.fakes.world.driving import above, deck_to, hovering


def with_scales(scenario: DeckScenario, **scales: float) -> DeckScenario:
    return scenario.model_copy(update={"imperfections": scales})


def grip(world: DeckOnFrame) -> np.ndarray:
    parts = world.placed.parts
    assert parts is not None
    return np.asarray(parts.flange_T_deck.as_matrix())


def test_slips_are_as_large_as_they_may_be(scenario: DeckScenario) -> None:
    slips = islice(grip_slips(with_scales(scenario, grip_slip=1.0), 1, 1), 300)
    shifts_m = np.array([slip.translation for slip in slips])
    assert np.abs(shifts_m).max() == pytest.approx(5e-6, rel=0.02)
    assert list(grip_slips(scenario, 1, 1)) == []


def test_a_deck_slips_with_every_start_until_the_frame_carries_it(scenario: DeckScenario) -> None:
    world = DeckOnFrame(with_scales(scenario, grip_slip=1.0), 1)
    grips = [grip(world)]
    hovering(world)
    grips.append(grip(world))
    deck_to(world, above(world, -40e-6), 1e-3, 0.02)
    grips.append(grip(world))
    assert world.payload.contact_force_n > 5
    deck_to(world, above(world, -45e-6), 1e-3, 0.02)
    carried = grip(world)
    slipped_m = np.linalg.norm(np.diff([one[:3, 3] for one in grips], axis=0), axis=1)
    assert (slipped_m > 1e-6).all()
    np.testing.assert_array_equal(carried, grips[-1])
    deck = world.cell_T_deck()
    assert deck is not None
    parts = world.placed.parts
    assert parts is not None
    rigid = world.flange("main") * parts.flange_T_deck
    assert distance(rigid, deck)[0] < 100e-6  # the springs alone


def test_a_burr_carries_before_the_rim_does(scenario: DeckScenario) -> None:
    burred = with_scales(scenario, burr=1.0)
    parts = draw_parts(burred, 1, 1)
    assert parts.burr_m is not None
    x_m, y_m, height_m = parts.burr_m
    assert height_m == pytest.approx(20e-6)
    assert max(abs(x_m) / 0.49, abs(y_m) / 0.24) == pytest.approx(1.0)
    forces_n = []
    for one in (scenario, burred):
        world = hovering(DeckOnFrame(one, 1))
        deck_to(world, above(world, 10e-6), 1e-3, 0.02)
        forces_n.append(world.payload.contact_force_n)
    assert forces_n[0] == 0.0
    assert forces_n[1] > 0.5


def test_draws_of_the_parts_are_those_without_a_burr(scenario: DeckScenario) -> None:
    plain = draw_parts(scenario, 3, 1)
    burred = draw_parts(with_scales(scenario, burr=2.0), 3, 1)
    assert plain.frame_holes == burred.frame_holes
    assert plain.contact_stiffness_n_m == burred.contact_stiffness_n_m


def test_each_head_sees_its_own_corner_of_a_bent_deck(scenario: DeckScenario) -> None:
    bent = with_scales(scenario, deck_flex=5.0)  # 0.1 mm at the corners
    for x_m, y_m in ((-0.48, -0.13), (0.48, 0.13), (0.0, 0.0)):
        # 0.5 m above the place, looking down: x of the camera along x of the deck.
        deck_T_camera = RigidTransform.from_components(
            [x_m, y_m, 0.5], Rotation.from_euler("x", 180, degrees=True)
        )
        tangent = deck_T_tangent(bent, deck_T_camera.inv())
        beside = np.array([[x_m, y_m], [x_m + 0.03, y_m], [x_m, y_m - 0.03]])
        seen = tangent.apply(np.column_stack([beside, np.zeros(3)]))
        np.testing.assert_allclose(-seen[:, 2], hang_m(bent, beside), atol=1e-6)
        assert np.abs(seen[:, :2] - beside).max() < 0.05e-6
    corner, middle = hang_m(bent, np.array([[0.5, -0.25], [0.0, 0.0]]))
    assert corner - middle == pytest.approx(0.1e-3)
    holes = np.array([hole.position_mm for hole in scenario.parts.holes]) * 1e-3
    assert hang_m(bent, holes).mean() == pytest.approx(0.0, abs=1e-9)


def test_a_flat_deck_is_seen_as_it_is(scenario: DeckScenario) -> None:
    assert deck_T_tangent(scenario, RigidTransform.identity()).as_matrix() == pytest.approx(
        np.eye(4)
    )


@pytest.mark.figures  # seconds of contact
def test_a_bent_deck_rests_on_its_corners(scenario: DeckScenario) -> None:
    bent = with_scales(scenario, deck_flex=5.0)
    grown_n = []
    for one in (scenario, bent):
        world = hovering(DeckOnFrame(one, 1))
        deck_to(world, above(world, -10e-6), 1e-3, 0.02)
        before_n = world.payload.contact_force_n
        deck_to(world, above(world, -20e-6), 1e-3, 0.02)
        grown_n.append(world.payload.contact_force_n - before_n)
    # The middles of the sides stay up. Half of the pads carry, and give way twice as far.
    assert 0 < grown_n[1] < 0.9 * grown_n[0]
