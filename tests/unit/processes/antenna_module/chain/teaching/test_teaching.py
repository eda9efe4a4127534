"""Taught plugs become a correction, or are refused with the reason."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import RigidTransform

from cellctl.errors.calibration import CalibrationRecordInvalid, WristConfigurationsDiffer
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.calibrations import PLUG_CORRECTION
from cellctl.processes.antenna_module.chain.schemes import DIFFERENCE
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.teaching import TaughtPlug, teach_plug
from cellctl.processes.antenna_module.faults.calibration import TeachScatter, TooFewTeachings
from cellctl.processes.antenna_module.faults.plugging import (
    CalibrationsDoNotBelongTogether,
    OutOfTaughtRange,
)
from tests.rigs.antenna import exact_cell as exact

SEATED = pose_from_xyzabc([0.03, -0.05, 0.2, 0.1, 0, 0])


def teach(plugs: list[TaughtPlug]) -> PlugCorrection:
    return teach_plug({"slot 1": plugs}, exact.cell(), DIFFERENCE)


def test_the_correction_is_where_plugs_sat() -> None:
    correction = teach(exact.taught_plugs(4, SEATED))
    (slot,) = correction.slots
    assert exact.distance(slot.socket_T_plug.pose, SEATED)[0] < 1e-8
    assert slot.scatter_m < 1e-8
    assert correction.passed
    # Four plugs, each with two approaches and the play of the gauge: about 10 µm over 2.
    assert 3e-6 < np.sqrt(slot.socket_T_plug.covariance[0, 0]) < 7e-6


def test_more_plugs_make_it_surer() -> None:
    four, eight = (
        teach(exact.taught_plugs(n)).slots[0].socket_T_plug.covariance[0, 0] for n in (4, 8)
    )
    assert eight == pytest.approx(four / 2, rel=0.05)


def test_the_order_of_the_taught_plugs_changes_nothing() -> None:
    plugs = exact.taught_plugs(6, SEATED, scatter_m=8e-6)
    found = teach(plugs).slots[0]
    for seed in range(3):
        order = np.random.default_rng(seed).permutation(len(plugs))
        again = teach([plugs[index] for index in order]).slots[0]
        off_m, off_rad = exact.distance(found.socket_T_plug.pose, again.socket_T_plug.pose)
        assert off_m < 1e-9
        assert off_rad < 1e-9
        assert again.scatter_m == pytest.approx(found.scatter_m, abs=1e-9)
        assert exact.distance(found.base_T_socket, again.base_T_socket)[0] < 1e-9


def test_three_plugs_are_too_few() -> None:
    with pytest.raises(TooFewTeachings, match="slot 1: 3"):
        teach(exact.taught_plugs(3))
    with pytest.raises(TooFewTeachings):
        teach_plug({}, exact.cell(), DIFFERENCE)


def test_plugs_that_scatter_are_refused() -> None:
    assert teach(exact.taught_plugs(4, scatter_m=8e-6)).passed
    with pytest.raises(TeachScatter, match=r"scatter|µm"):
        teach(exact.taught_plugs(4, scatter_m=25e-6))


def test_one_outlier_is_named() -> None:
    plugs = exact.taught_plugs(6)
    wrong = replace(
        plugs[3], base_T_flange=pose_from_xyzabc([0.1, 0, 0, 0, 0, 0]) * plugs[3].base_T_flange
    )
    with pytest.raises(TeachScatter, match="plug 3"):
        teach([*plugs[:3], wrong, *plugs[4:]])


def test_plugs_of_two_connectors_or_wrists_are_refused() -> None:
    plugs = exact.taught_plugs(4)
    looks = plugs[0].looks
    other = replace(plugs[0], looks=replace(looks, plug=replace(looks.plug, connector="da-15")))
    with pytest.raises(CalibrationsDoNotBelongTogether):
        teach([other, *plugs[1:]])
    folded = replace(looks.plug, joints_rad=-looks.plug.joints_rad)
    with pytest.raises(WristConfigurationsDiffer):
        teach([replace(plugs[0], looks=replace(looks, plug=folded)), *plugs[1:]])


def test_the_record_is_read_back() -> None:
    correction = teach(exact.taught_plugs(4, SEATED))
    again = PLUG_CORRECTION.result(correction.to_record())
    assert again.made_with == correction.made_with
    assert (again.wrist, again.checks) == (correction.wrist, correction.checks)
    assert again.range_m == pytest.approx(correction.range_m)
    assert len(again.slots) == len(correction.slots)
    for read, written in zip(again.slots, correction.slots, strict=True):
        assert (read.name, read.plugs) == (written.name, written.plugs)
        assert read.scatter_m == pytest.approx(written.scatter_m)
        assert read.scatter_rad == pytest.approx(written.scatter_rad)
        # Lengths go through millimetres and angles through degrees: not to the last digit.
        for name in ("base_T_socket", "socket_T_plug"):
            poses = [getattr(slot, name) for slot in (read, written)]
            a, b = (getattr(pose, "pose", pose).as_matrix() for pose in poses)
            np.testing.assert_allclose(a, b, atol=1e-12)
        np.testing.assert_allclose(
            read.socket_T_plug.covariance, written.socket_T_plug.covariance, rtol=1e-9, atol=1e-30
        )


RECORD = teach(exact.taught_plugs(4)).to_record()


@given(
    key=st.sampled_from(["made_with", "wrist", "range_mm", "slots"]),
    broken=st.sampled_from([None, [], {}, "x", [None], [{}], [0, 1], [1, 1, 1]]),
)
def test_a_damaged_record_is_refused_by_name(key: str, broken: object) -> None:
    with pytest.raises(CalibrationRecordInvalid):
        PLUG_CORRECTION.result({**RECORD, key: broken})


def test_every_fault_that_moves_something_invalidates_it() -> None:
    names = {fault.__name__ for fault in PLUG_CORRECTION.invalidated_by}
    assert {"GripperMarksMoved", "FlangeCameraMoved", "ArmMoved"} <= names


def test_a_place_that_is_not_a_number_is_out_of_range() -> None:
    correction = teach(exact.taught_plugs(4, SEATED))
    with pytest.raises(OutOfTaughtRange):
        correction.slot_for(RigidTransform.from_translation([np.nan, 0.0, 0.0]))
