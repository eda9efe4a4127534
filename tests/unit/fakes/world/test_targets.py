import numpy as np
import pytest

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from tests.rigs.sweeps import sweep
from tests.unit.fakes.world.driving import to_taught


def test_flange_targets_lie_on_their_ring(scenario: DeckScenario) -> None:
    world = DeckOnFrame(scenario, 1)
    to_taught(world, "main", "clear")
    places = np.array([target.position_m for target in world.targets("tracker", 100)])
    assert len(places) == 6
    radius = np.linalg.norm(places - places.mean(axis=0), axis=1)
    np.testing.assert_allclose(radius, 0.2, atol=1.5e-3)


@pytest.mark.figures  # many draws
def test_noise_averages_out_over_frames(scenario: DeckScenario) -> None:
    world = DeckOnFrame(scenario, 1)
    for frames in (1, 25):
        rows = np.array([world.targets("tracker", frames)[0].position_m for _ in range(200)])
        sigma = scenario.trackers["tracker"].noise_mm / 1000 / np.sqrt(frames)
        assert world.targets("tracker", frames)[0].sigma_m == pytest.approx(sigma)
        np.testing.assert_allclose(rows.std(axis=0), sigma, rtol=0.2)


def test_flange_turned_away_is_not_seen(scenario: DeckScenario) -> None:
    world = DeckOnFrame(scenario, 1)
    world.arms["main"].start_joint(0.0, np.deg2rad([0, -60, 0, 0, -60, 0]), 100)
    world.advance(world.arms["main"].standstill_s)
    assert world.targets("tracker", 1) == ()


@pytest.mark.parametrize(
    ("axis", "arc_deg"), sweep(((0, (-50, 50)), (1, (-125, -35))), ((0, (-50, 50)),))
)
def test_targets_stay_in_view_over_the_calibration_arcs(
    scenario: DeckScenario, axis: int, arc_deg: tuple[int, int]
) -> None:
    world = DeckOnFrame(scenario, 1)
    arm, joints = world.arms["main"], np.deg2rad([0, -80.0, 110, 0, 60, 90])
    for angle in np.linspace(*arc_deg, 7):
        joints[axis] = np.deg2rad(angle)
        arm.start_joint(world.time_s, joints.copy(), 100)
        world.advance(arm.standstill_s)
        assert len(world.targets("tracker", 1)) == 6
