"""A correction is checked with plugs that it was not taught with."""

from dataclasses import replace

import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.errors.calibration import WristConfigurationsDiffer
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.processes.antenna_module.chain.schemes import DIFFERENCE
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.taught_check import checked_with
from cellctl.processes.antenna_module.chain.teaching.teaching import TaughtPlug, teach_plug
from cellctl.processes.antenna_module.faults.plugging import CalibrationsDoNotBelongTogether
from tests.rigs.antenna import exact_cell as exact

SEATED = pose_from_xyzabc([0.03, -0.05, 0.2, 0.1, 0, 0])


def taught() -> tuple[PlugCorrection, TaughtPlug]:
    """A correction, and a plug that sat where it says."""
    *plugs, further = exact.taught_plugs(5, SEATED)
    correction = teach_plug({"1": plugs}, exact.cell(), DIFFERENCE)
    return correction, replace(further, name="checked plug 1")


def check(correction: PlugCorrection, *plugs: TaughtPlug) -> PlugCorrection:
    return checked_with(correction, plugs, exact.cell(), DIFFERENCE)


def test_plugs_that_sit_where_it_says_pass() -> None:
    correction, plug = taught()
    checked = check(correction, plug, plug)
    assert checked.passed
    assert len(checked.checks) == len(correction.checks) + 4
    assert all(one.value < 1e-6 for one in checked.checks[len(correction.checks) :])
    # What is planned by does not change.
    assert checked.slots == correction.slots
    assert check(correction).to_record() == correction.to_record()


@pytest.mark.parametrize(
    ("off_mm_deg", "failed"),
    [
        ((0.06, 0.0, 0.0, 0.0, 0.0, 0.0), "checked plug 1: offset"),
        ((0.0, 0.0, 0.0, 0.15, 0.0, 0.0), "checked plug 1: yaw"),
    ],
)
def test_a_plug_that_sits_elsewhere_fails_the_correction(
    off_mm_deg: tuple[float, ...], failed: str
) -> None:
    correction, plug = taught()
    # About the socket: a turn about the base would move the plug, too.
    about = RigidTransform.from_translation(exact.BASE_T_SOCKET.translation)
    off = about * pose_from_xyzabc(off_mm_deg) * about.inv()
    checked = check(correction, replace(plug, base_T_flange=off * plug.base_T_flange))
    assert not checked.passed
    assert failed in {one.name for one in checked.checks if not one.passed}


def test_a_plug_of_another_set_is_refused() -> None:
    correction, plug = taught()
    looks = plug.looks
    folded = replace(looks.plug, joints_rad=-looks.plug.joints_rad)
    turned = tuple(replace(one, joints_rad=-one.joints_rad) for one in looks.sockets)
    other = replace(looks, plug=folded, sockets=turned, plate=None)
    with pytest.raises(WristConfigurationsDiffer):
        check(correction, replace(plug, looks=other))
    foreign = replace(looks, plug=replace(looks.plug, camera_id="camera 9"))
    with pytest.raises(CalibrationsDoNotBelongTogether):
        check(correction, replace(plug, looks=foreign))
