"""A plan says how sure it is, and refuses what it must not answer."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationMissing, WristConfigurationsDiffer
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell
from cellctl.processes.antenna_module.chain.looks import Looks
from cellctl.processes.antenna_module.chain.plan import PlugPlan, PlugTolerance, plan_plug
from cellctl.processes.antenna_module.chain.schemes import ABSOLUTE, DIFFERENCE, GOLDEN
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.teaching import teach_plug
from cellctl.processes.antenna_module.chain.termed_pose import Term
from cellctl.processes.antenna_module.chain.worst_contact import (
    contact_offsets,
    predict_worst_contact,
)
from cellctl.processes.antenna_module.faults.plugging import (
    CalibrationsDoNotBelongTogether,
    LooksIncomplete,
    OutOfTaughtRange,
    PlugUncertain,
    StaleLook,
)
from tests.rigs.antenna import exact_cell as exact

NOW_S = 30.0


@pytest.fixture(scope="module")
def correction() -> PlugCorrection:
    return teach_plug({"slot": exact.taught_plugs()}, exact.cell(), DIFFERENCE)


def plan(looks: Looks, correction: PlugCorrection | None, cell: PlugCell | None = None) -> PlugPlan:
    return plan_plug(
        looks,
        cell or exact.cell(),
        DIFFERENCE,
        exact.PATTERN,
        now_s=NOW_S,
        correction=correction,
    )


def test_a_plan_of_the_difference_scheme_is_within_tolerance(correction: PlugCorrection) -> None:
    made = plan(exact.looks(), correction)
    assert exact.distance(made.base_T_flange.pose, exact.TARGET)[0] < 1e-6
    # The published budget for this robot, taught four times, one look: 10.6 µm and drift.
    in_plane = np.sqrt(np.trace(made.socket_T_plug.covariance[:2, :2]) / 2)
    assert 10e-6 < in_plane < 14e-6
    assert made.worst.p99_m == pytest.approx(3.03 * in_plane, rel=0.1)
    squares = sum(value**2 for value in made.terms_m.values())
    assert np.sqrt(squares) == pytest.approx(in_plane, rel=1e-6)
    record = made.to_record()
    assert set(record["terms_um"]) >= {
        "look_plug", "look_socket", "approach", "correction", "drift",
    }  # fmt: skip


def test_the_published_chain_is_too_uncertain_for_50_um() -> None:
    with pytest.raises(PlugUncertain, match=r"p99 .* largest term"):
        plan_plug(exact.looks(), exact.cell(), ABSOLUTE, exact.PATTERN, now_s=NOW_S)
    wide = PlugTolerance(worst_contact_m=500e-6)
    made = plan_plug(
        exact.looks(), exact.cell(), ABSOLUTE, exact.PATTERN, now_s=NOW_S, tolerance=wide
    )
    assert made.slot is None
    assert made.terms_m[Term.KINEMATICS] > 20e-6


def other_intrinsics(looks: Looks) -> Looks:
    return replace(looks, plug=replace(looks.plug, camera_id="another"))


def older(looks: Looks) -> Looks:
    return replace(looks, plug=replace(looks.plug, time_s=NOW_S - 61.0))


def from_the_future(looks: Looks) -> Looks:
    return replace(looks, plug=replace(looks.plug, time_s=NOW_S + 0.1))


def without_time(looks: Looks) -> Looks:
    return replace(looks, plug=replace(looks.plug, time_s=float("nan")))


def other_wrist(looks: Looks) -> Looks:
    joints = looks.plug.joints_rad * [1, 1, 1, 1, -1, 1]
    return replace(looks, plug=replace(looks.plug, joints_rad=joints))


def straight_wrist(looks: Looks) -> Looks:
    joints = np.zeros(6)
    sockets = tuple(replace(one, joints_rad=joints) for one in looks.sockets)
    return replace(looks, plug=replace(looks.plug, joints_rad=joints), sockets=sockets, plate=None)


def all_in_another_wrist(looks: Looks) -> Looks:
    joints = looks.plug.joints_rad * [1, 1, 1, 1, -1, 1]
    sockets = tuple(replace(one, joints_rad=joints) for one in looks.sockets)
    return replace(looks, plug=replace(looks.plug, joints_rad=joints), sockets=sockets, plate=None)


def other_connector(looks: Looks) -> Looks:
    return replace(looks, plug=replace(looks.plug, connector="da-15"))


def two_sorts_of_socket(looks: Looks) -> Looks:
    two = exact.looks(sockets=2).sockets
    return replace(looks, sockets=(two[0], replace(two[1], connector="da-15 holes")))


def without_socket(looks: Looks) -> Looks:
    return replace(looks, sockets=())


def far_away(_: Looks) -> Looks:
    return exact.looks(base_T_socket=pose_from_xyzabc([0, 201, 0, 0, 0, 0]) * exact.BASE_T_SOCKET)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (other_intrinsics, CalibrationsDoNotBelongTogether),
        (older, StaleLook),
        (from_the_future, StaleLook),
        (without_time, StaleLook),
        (other_wrist, WristConfigurationsDiffer),
        (straight_wrist, WristConfigurationsDiffer),
        (all_in_another_wrist, WristConfigurationsDiffer),
        (other_connector, CalibrationsDoNotBelongTogether),
        (two_sorts_of_socket, CalibrationsDoNotBelongTogether),
        (without_socket, LooksIncomplete),
        (far_away, OutOfTaughtRange),
    ],
)
def test_looks_that_do_not_fit_are_refused(
    correction: PlugCorrection, change: Callable[[Looks], Looks], fault: type[CellError]
) -> None:
    with pytest.raises(fault):
        plan(change(exact.looks()), correction)


def test_a_correction_of_another_cell_is_refused(correction: PlugCorrection) -> None:
    cell = exact.cell()
    for other, word in (
        (replace(cell, gripper="gripper 4"), "gripper"),
        (replace(cell, cam1=replace(cell.cam1, id="newer")), "cam1"),
        (replace(cell, cam2=replace(cell.cam2, id="newer")), "cam2"),
    ):
        with pytest.raises(CalibrationsDoNotBelongTogether, match=word):
            plan(exact.looks(), correction, other)
    with pytest.raises(CalibrationsDoNotBelongTogether, match="scheme"):
        plan_plug(exact.looks(), cell, GOLDEN, exact.PATTERN, now_s=NOW_S, correction=correction)


def test_a_taught_scheme_without_correction_is_refused() -> None:
    with pytest.raises(CalibrationMissing):
        plan(exact.looks(), None)


def test_the_plan_grows_less_sure_away_from_the_taught_slot(correction: PlugCorrection) -> None:
    away = exact.looks(base_T_socket=pose_from_xyzabc([0, 150, 0, 0, 0, 0]) * exact.BASE_T_SOCKET)
    near, far = plan(exact.looks(), correction), plan(away, correction)
    assert far.distance_m == pytest.approx(0.15, abs=2e-3)
    assert far.worst.p99_m > near.worst.p99_m


def test_worst_contact_without_yaw_is_the_radius_of_the_centre() -> None:
    covariance = np.diag([1e-10, 1e-10, 0, 0, 0, 0])
    worst = predict_worst_contact(covariance, exact.PATTERN.positions_m, exact.PATTERN.names)
    assert worst.p99_m == pytest.approx(np.sqrt(2 * np.log(100)) * 1e-5, rel=0.02)


def test_yaw_moves_the_outer_contacts() -> None:
    covariance = np.diag([0, 0, 0, 0, 0, 1e-6])
    worst = predict_worst_contact(covariance, exact.PATTERN.positions_m, exact.PATTERN.names)
    assert worst.name in {"left", "right"}
    assert worst.p99_m == pytest.approx(2.576 * 1e-3 * 4.4e-3, rel=0.03)
    offsets = contact_offsets(np.array([[1e-5, 0, 1e-3]]), exact.PATTERN.positions_m)
    np.testing.assert_allclose(offsets[0, 2], np.hypot(1e-5 - 1.3e-6, 0.0))
