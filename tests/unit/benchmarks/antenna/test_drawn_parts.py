"""The parts of which the antenna module's drawn cells are made."""

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from benchmarks.antenna.chain.arms import FACTORY, IDEAL, RP_002, DrawnArm, Grade, Repeatability
from benchmarks.antenna.chain.closing_look import close_by_steps
from benchmarks.antenna.chain.drawn_cell import FLANGE_T_PLUG, PLUG_STATION, SOCKET
from benchmarks.antenna.chain.optics import DrawnOptics
from benchmarks.antenna.chain.trials import CONTACTS_M
from benchmarks.antenna.insertion.trials import FAULTS, run_insertion

EXACT = Repeatability("exact", 0.0, 0.0)
POSES = [PLUG_STATION * FLANGE_T_PLUG.inv(), SOCKET * FLANGE_T_PLUG.inv()]


def arm(grade: Grade, repeatability: Repeatability = EXACT) -> DrawnArm:
    return DrawnArm.draw(np.random.default_rng(1), grade, repeatability)


@pytest.mark.parametrize("pose", POSES)
def test_an_ideal_arm_goes_where_it_is_sent(pose: RigidTransform) -> None:
    between = pose.inv() * arm(IDEAL).mean_place(pose)
    assert np.linalg.norm(between.translation) < 1e-9
    assert between.rotation.magnitude() < 1e-9


@pytest.mark.parametrize("pose", POSES)
def test_a_real_arm_is_off_and_reports_the_pose_that_leads_there(pose: RigidTransform) -> None:
    one, rng = arm(FACTORY), np.random.default_rng(2)
    assert 2e-5 < np.linalg.norm((pose.inv() * one.mean_place(pose)).translation) < 2e-3
    reported = one.reported(pose, rng)
    assert np.linalg.norm(one.mean_place(reported).translation - pose.translation) < 1e-8


def test_approaches_scatter_as_the_standard_says() -> None:
    one, rng = arm(IDEAL, RP_002), np.random.default_rng(3)
    places = np.array([one.place(POSES[0], rng).translation for _ in range(120)])
    radii = np.linalg.norm(places - places.mean(axis=0), axis=1)
    assert radii.mean() + 3 * radii.std() == pytest.approx(20e-6, rel=0.2)


def test_an_exact_camera_finds_the_contacts_in_their_plane() -> None:
    rng = np.random.default_rng(4)
    drawn = DrawnOptics.draw(rng, 0.0)
    exact = DrawnOptics(drawn.true, drawn.true, np.zeros(2))
    plane = RigidTransform.from_translation([0.001, -0.002, 0.25])
    shift = RigidTransform.from_translation([3e-4, 2e-4, 0.0])
    seen = exact.look(plane * shift, CONTACTS_M, plane, 0.0, rng)
    np.testing.assert_allclose(seen.pose.as_matrix(), (plane * shift).as_matrix(), atol=1e-12)


def test_the_closing_look_leaves_a_few_micrometres() -> None:
    rng = np.random.default_rng(5)
    left = np.array(
        [close_by_steps(np.array([60e-6, -40e-6, 0.0]), np.zeros(3), rng) for _ in range(200)]
    )
    assert 1e-6 < np.sqrt((left[:, :2] ** 2).mean()) < 6e-6


def test_a_bent_pin_is_stopped_before_it_collapses() -> None:
    outcome = run_insertion(FAULTS[1], seed=7)
    assert outcome.caught
    assert not outcome.collapsed
    assert outcome.standing_n < 20
