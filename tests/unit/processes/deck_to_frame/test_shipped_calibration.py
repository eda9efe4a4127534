"""The calibration that ships with the fake cell is what its procedures make, and it is true.

`make demo-calibration` writes these files. They belong to the devices of the scenario's
hardware seed, so every result can be held against the devices as they really are.
"""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.arm_reference import (
    MOVED_M,
    ArmReference,
    require_arm_at_reference,
    target_offsets,
)
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.errors.robot import ArmOffReference
from cellctl.geometry.pose import MM, pose_error
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import Target
from cellctl.processes.deck_to_frame.calibrations import BASE_FRAME, CALIBRATIONS, PAYLOAD
from cellctl.processes.deck_to_frame.commissioned_contact import Commissioned
from cellctl.processes.deck_to_frame.poses.geometry import CalibrationSet
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.frames import from_written
from fakes.world.scene import StereoTruth
from tests.rigs.sweeps import sweep
from tests.unit.fakes.world.driving import to_taught

CONFIG = Path(__file__).parents[4] / "config"
SIGMAS = 5.0
IN_MANY_YEARS = datetime(2040, 1, 1, tzinfo=UTC)


@pytest.fixture(scope="module")
def calibrations() -> CalibrationSnapshot:
    store = CalibrationStore(CONFIG / "demo-calibration", CALIBRATIONS)
    return store.read_all([kind.for_recipe(1) for kind in CALIBRATIONS], utc_now())


@pytest.fixture(scope="module")
def geometry(calibrations: CalibrationSnapshot) -> CalibrationSet:
    return CalibrationSet.of(calibrations)


@pytest.fixture(scope="module")
def world() -> DeckOnFrame:
    world = DeckOnFrame(DeckScenario.read(CONFIG / "deck.scenario.toml"), 1)
    for robot, pose in (("aux_1", "measure"), ("aux_2", "measure"), ("main", "clear")):
        to_taught(world, robot, pose)
    return world


def test_fake_devices_do_not_age_so_their_calibrations_never_expire() -> None:
    store = CalibrationStore(CONFIG / "demo-calibration", CALIBRATIONS, lambda: IN_MANY_YEARS)
    assert store.fault(CALIBRATIONS, timedelta(hours=1), newest=IN_MANY_YEARS) is None


@pytest.mark.parametrize("seed", sweep(range(1, 13), (1, 2)))
def test_the_arm_stands_where_its_base_frame_was_measured_until_it_is_mastered_anew(
    calibrations: CalibrationSnapshot, seed: int
) -> None:
    """What procedure 109 compares on a fresh fake cell, whatever its seed: the arm is the one that
    was calibrated, on another day."""
    reference = calibrations.get(BASE_FRAME).reference
    assert reference is not None
    assert len(reference.targets) == 6
    world = DeckOnFrame(DeckScenario.read(CONFIG / "deck.scenario.toml"), seed)
    arm = world.arms["main"]

    def look() -> ArmReference:
        arm.start_joint(world.time_s, reference.joints_rad, 50)
        world.advance(arm.standstill_s + 1.0)
        seen = world.targets("tracker", 25)
        targets = (Target(one.name, one.position_m, one.sigma_m) for one in seen)
        return ArmReference(reference.joints_rad, tuple(targets))

    assert require_arm_at_reference(target_offsets(reference, look())) < MOVED_M
    arm.master(1, np.radians(0.03))
    with pytest.raises(ArmOffReference):
        require_arm_at_reference(target_offsets(reference, look()))


@pytest.mark.parametrize("index", [0, 1])
def test_heads_see_points_where_they_are(
    geometry: CalibrationSet, world: DeckOnFrame, index: int
) -> None:
    """What counts is a distance measured in the working volume, not single parameters."""
    head = geometry.heads[index]
    truth = world.truth.cameras[("head_1", "head_2")[index]].optics
    assert isinstance(truth, StereoTruth)
    baseline_m = np.linalg.norm(head.translation_m)
    true_baseline_m = np.linalg.norm(truth.right_T_left.translation)
    assert baseline_m == pytest.approx(true_baseline_m, abs=0.05 * MM)
    for camera, lens in ((head.left, truth.left), (head.right, truth.right)):
        assert camera.camera_matrix[0, 0] == pytest.approx(lens.focal_px[0], rel=5e-4)
    turn = np.linalg.norm(
        (truth.right_T_left.inv() * head.right_T_left).rotation.as_rotvec(degrees=True)
    )
    assert turn < 0.02


def test_base_frame_is_where_it_says_within_its_uncertainty(
    geometry: CalibrationSet, world: DeckOnFrame
) -> None:
    """What the data sheet says of d1 and of A1 is only as true as the arm was built."""
    truth = world.truth.trackers["tracker"].cell_T_tracker.inv()
    arm = world.scenario.robots["main"]
    built_m = arm.link_sigma_mm * MM
    built_rad = np.radians(np.hypot(arm.link_sigma_deg, arm.joint_sigma_deg))
    built = np.diag(np.repeat([built_m**2, built_rad**2], 3))
    measured = geometry.c_T_base
    assert_within(UncertainPose(measured.pose, measured.covariance + built), truth)


def test_heads_are_where_they_say(geometry: CalibrationSet, world: DeckOnFrame) -> None:
    report = world.report()
    for pose, key, allowed_mm, allowed_deg in (
        (geometry.base_T_c1, "base_T_c1_mm_deg", 0.3, 0.03),
        (geometry.base_T_c2, "base_T_c2_mm_deg", 0.3, 0.03),
        (geometry.c1_T_c2, "c1_T_c2_mm_deg", 0.3, 0.03),
    ):
        shift_m, turn_rad = pose_error(from_written(report[key]), pose.pose)
        assert np.linalg.norm(shift_m) < allowed_mm * MM, key
        assert np.degrees(np.linalg.norm(turn_rad)) < allowed_deg, key


def test_the_payload_weighs_what_it_weighs(calibrations: CalibrationSnapshot) -> None:
    scenario = DeckScenario.read(CONFIG / "deck.scenario.toml")
    weight_n = 9.80665 * (scenario.payload.gripper_kg + scenario.payload.deck_kg)
    down = calibrations.get(PAYLOAD).gravity_compensation.A[:3] @ np.array([0.0, 0.0, 1.0])
    assert np.linalg.norm(down) == pytest.approx(weight_n, rel=0.02)


def test_latency_and_stiffness_are_true_and_on_the_safe_side(
    calibrations: CalibrationSnapshot, world: DeckOnFrame
) -> None:
    """The bound of the latency is above the latest stop of the fake robot, whose stops differ
    from one to the next; other parts may be stiffer, within the recipe's."""
    found = Commissioned.of(calibrations, recipe_id=1)
    assert found.stop_latency_s is not None
    assert found.stiffness_n_m is not None
    mean_s = world.scenario.robots["main"].stop_latency_ms / 1e3
    latest_s = mean_s * (1 + world.scenario.size_of("stop_jitter"))
    assert latest_s < found.stop_latency_s < latest_s + 0.03
    arm = world.scenario.payload.stiffness_n_m[2]
    stiffest = world.scenario.contact.stiffness_n_m[1]
    assert 1.5 * found.stiffness_n_m > arm * stiffest / (arm + stiffest)
    assert found.stiffness_n_m < arm


def assert_within(measured: UncertainPose, truth: RigidTransform) -> None:
    delta = np.concatenate(pose_error(truth, measured.pose))
    distance = float(np.sqrt(delta @ np.linalg.solve(measured.covariance, delta)))
    assert distance < SIGMAS, f"{distance:.1f} standard deviations from the truth"
