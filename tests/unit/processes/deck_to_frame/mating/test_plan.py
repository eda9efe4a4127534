from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.force import ContactPlanInvalid, SensorSilent
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.processes.deck_to_frame.faults import LateralLoad, MatingOverforce
from cellctl.processes.deck_to_frame.mating.limits import (
    contact_limits,
    fault_of,
    touch_limits,
    travel_limits,
)
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan, plan_mating
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings, PinSettings

SETTINGS = MatingSettings(stop_latency_s=0.26, stiffness_n_m=7.6e5)
STAND_OFF = pose_from_xyzabc([1900.0, 0.0, 927.0, 90.0, 0.0, 180.0])
FLANGE_T_DECK = pose_from_xyzabc([1.5, -2.0, 502.3, 0.2, 0.1, 179.9])


def plan(
    settings: MatingSettings = SETTINGS, z_mm: float = 25.02, sigma_mm: float = 0.005
) -> MatingPlan:
    sigma = np.repeat([sigma_mm * 1e-3, np.deg2rad(0.0005)], 3)
    measured = pose_from_xyzabc([0.01, -0.02, z_mm, 0.0, 0.003, 0.001])
    return plan_mating(
        base_T_flange=STAND_OFF,
        flange_T_deck=FLANGE_T_DECK,
        flange_T_sensor=pose_from_xyzabc([0.0, 0.0, 60.0, 0.0, 0.0, 0.0]),
        M_T_D=UncertainPose(measured, np.diag(sigma**2)),
        deck_thickness_m=0.015,
        over_travel_m=0.010,
        settings=settings,
    )


def test_contact_is_expected_where_the_deck_reaches_its_thickness() -> None:
    window = plan().window
    assert window.expected_m == pytest.approx(0.01002)
    assert window.clear_m < window.earliest_m < window.expected_m < window.latest_m
    assert window.latest_m - window.expected_m <= SETTINGS.greatest_past_m


def test_the_slow_travel_takes_less_than_fifteen_seconds() -> None:
    found = plan()
    slow_m = found.window.latest_m - found.window.clear_m
    moves = np.ceil(slow_m / found.segment_m)
    assert slow_m / found.speed.speed_m_s + 0.1 * moves < 15.0


def test_travel_and_pose_are_inverse_of_each_other() -> None:
    found = plan()
    for travel_m in (0.0, 0.004, 0.01):
        assert found.travel_of(found.pose_at(travel_m)) == pytest.approx(travel_m, abs=1e-12)
    lowered = found.pose_at(0.01) * FLANGE_T_DECK
    deck = STAND_OFF * FLANGE_T_DECK
    np.testing.assert_allclose(deck.inv().apply(lowered.translation), [0, 0, -0.01], atol=1e-12)


def test_pins_are_approached_by_the_bound_of_the_arm_however_soft_the_seat_was_measured() -> None:
    soft = replace(SETTINGS, stiffness_n_m=1.4e5)
    pins = PinSettings(engagement_m=1.3e-3)
    seat, found = plan(soft), plan(replace(soft, pins=pins))
    figures = found.speed.figures
    assert figures.stiffness_n_m == pins.stiffness_n_m > 5.0 * soft.stiffness_n_m
    assert figures.contact_stiffness_n_m == pins.contact_stiffness_n_m
    assert found.speed.speed_m_s < 0.5 * seat.speed.speed_m_s
    overrun_m = found.segment_m + 3.0 * soft.step_sigma_m
    unstopped_n = soft.touch.drift_n + soft.tare_uncertainty_n + pins.stiffness_n_m * overrun_m
    assert unstopped_n <= soft.abort_force_n + 1e-9
    assert found.creep == seat.creep, "the creep presses the seat and no pin"


def test_a_deck_that_is_known_badly_is_not_mated() -> None:
    with pytest.raises(ContactPlanInvalid, match="known to"):
        plan(sigma_mm=0.1)


def test_targets_may_not_reach_the_hard_end() -> None:
    with pytest.raises(ContactPlanInvalid, match="D3"):
        plan(replace(SETTINGS, greatest_past_m=0.02))


def test_the_guard_must_stop_below_the_limit() -> None:
    with pytest.raises(ContactPlanInvalid, match="at or above the limit"):
        plan(replace(SETTINGS, limit_force_n=45.0))


def test_a_force_window_without_room_is_refused() -> None:
    with pytest.raises(ContactPlanInvalid, match="no window"):
        plan(replace(SETTINGS, abort_force_n=42.0))


def test_the_touch_is_watched_in_the_slow_travel_only() -> None:
    assert travel_limits(SETTINGS).touch is None
    assert touch_limits(SETTINGS).touch is not None
    assert contact_limits(SETTINGS).touch is None
    assert contact_limits(SETTINGS).filtered[2] == SETTINGS.abort_force_n
    assert travel_limits(SETTINGS).filtered[2] < SETTINGS.target_force_n


@pytest.mark.parametrize(
    ("reason", "component", "fault"),
    [
        (TripReason.FILTERED_LIMIT, 2, MatingOverforce),
        (TripReason.RAW_LIMIT, 2, MatingOverforce),
        (TripReason.RAW_LIMIT, 0, LateralLoad),
        (TripReason.FILTERED_LIMIT, 4, LateralLoad),
        (TripReason.SENSOR_SILENT, None, SensorSilent),
    ],
)
def test_every_trip_has_its_fault(
    reason: TripReason, component: int | None, fault: type[Exception]
) -> None:
    assert isinstance(fault_of(GuardTrip(reason, 1.0, "facts", component), SETTINGS), fault)


def test_a_tilted_deck_may_touch_earlier() -> None:
    level = plan().window
    sigma = np.repeat([5e-6, np.deg2rad(0.0005)], 3)
    tilted = RigidTransform.from_components(
        [0.0, 0.0, 0.02502], Rotation.from_rotvec([0.0, np.deg2rad(0.02), 0.0])
    )
    found = plan_mating(
        base_T_flange=STAND_OFF,
        flange_T_deck=FLANGE_T_DECK,
        flange_T_sensor=RigidTransform.identity(),
        M_T_D=UncertainPose(tilted, np.diag(sigma**2)),
        deck_thickness_m=0.015,
        over_travel_m=0.010,
        settings=SETTINGS,
    )
    assert level.earliest_m - found.window.earliest_m > 1e-4
