"""What the steps find out, as it lies in the store."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cellctl.clock import now_s
from cellctl.force.contact.curve import ForceCurve
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces import StereoPair
from cellctl.interfaces.exposure import ExposureRecord
from cellctl.processes.deck_to_frame.mating.result import MatingPhase, MatingProgress
from cellctl.processes.deck_to_frame.record.deck_recorder import draw
from cellctl.processes.deck_to_frame.record.entries import rms_um
from cellctl.records.entries import PoseOrigin, Verdict
from cellctl.records.files.curve_file import read_recording
from cellctl.records.files.mcap_reading import read_raw
from cellctl.records.looks import rims_of, taken_images
from cellctl.vision.camera.ellipse import Ellipse
from cellctl.vision.measurement import HoleMeasurement, PairMeasurement
from cellctl.vision.picture import INSET_PX
from tests.unit.cell.bench import SIGMA, measurement
from tests.unit.processes.deck_to_frame.rig import RunRig, curve

PLACE = pose_from_xyzabc([10, 20, 500, 5, 1, 179])


def ended(felt: ForceCurve) -> MatingProgress:
    return MatingProgress(MatingPhase.ENDED, 0.01, 36.0, curve=felt)


async def test_a_measurement_with_its_pictures(rig: RunRig) -> None:
    found = measurement(PLACE, PLACE, rig.bench.features()[0], SIGMA)
    for _ in range(2):
        await rig.recorder.measurement("frame", found)
    record = await rig.record()
    entry = record.measurements[0]
    assert entry.pose_mm_deg == pytest.approx((10, 20, 500, 5, 1, 179))
    assert entry.sigma_mm_deg is not None
    assert entry.sigma_mm_deg[:3] == pytest.approx(SIGMA[:3] * 1e3)
    covariance = np.array(entry.covariance_mm_deg)
    assert covariance.shape == (6, 6)
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), np.array(entry.sigma_mm_deg, float))
    reported = [pose for pose in record.poses if pose.origin is PoseOrigin.REPORTED]
    assert [(pose.key, pose.parent, pose.child) for pose in reported] == [
        ("frame", "base", "flange")
    ] * 2
    assert entry.detail["outliers"] == ()
    assert set(entry.detail["residuals_mm"]) == {h.name for h in rig.bench.features()[0].holes}
    names = [artefact.name for artefact in record.artefacts]
    assert names[0] == "frame-head-1-left.jpg"
    assert names[4] == "frame-again-2-head-1-left.jpg", "the second does not hide the first"
    assert len(set(names)) == 8


async def test_residuals_are_summed_up(rig: RunRig) -> None:
    found = measurement(PLACE, PLACE, rig.bench.features()[0], SIGMA)
    found.pose.residuals_m[:, 0] = 3e-6
    found.pose.residuals_m[:, 2] = 4e-6
    assert rms_um(found) == pytest.approx(5.0)


async def test_the_fit_of_a_measurement_has_its_verdict(rig: RunRig) -> None:
    found = measurement(PLACE, PLACE, rig.bench.features()[0], SIGMA)
    found.pose.residuals_m[0] = (0.0, 0.15e-3, 0.0)
    await rig.recorder.measurement("deck", found)
    found.pose.residuals_m[0] = (0.0, 0.25e-3, 0.0)
    await rig.recorder.measurement("seated", found)
    record = await rig.record()
    figures = record.newest_figures
    assert figures["worst_residual.deck"].value == pytest.approx(150.0)
    assert figures["worst_residual.deck"].verdict is Verdict.PASS
    assert figures["worst_residual.seated"].verdict is Verdict.FAIL
    fit = record.measurements[0].detail["fit"]
    assert set(fit) == {"verdict", "chi2", "chi2_limit", "freedom", "sigma_factor"}
    assert fit["verdict"] == "explained by the stated uncertainties"


async def test_the_grip_is_recorded(rig: RunRig) -> None:
    await rig.recorder.deck_on_flange(UncertainPose(PLACE, np.diag(SIGMA**2)))
    assert (await rig.record()).measurements[0].key == "flange_T_deck"


async def test_force_curves_are_kept_once_and_can_be_read(rig: RunRig) -> None:
    rig.recorder.mating_progress(ended(curve(50, 20.0)))
    await rig.recorder.force_curves()
    rig.recorder.mating_progress(MatingProgress(MatingPhase.SLOW, 0.009, 0.0))
    rig.recorder.mating_progress(ended(curve(80, 36.0)))
    rig.recorder.mating_progress(ended(ForceCurve(np.zeros(0), np.zeros((0, 6)), np.zeros(0))))
    await rig.recorder.force_curves()
    await rig.recorder.force_curves()
    record = await rig.record()
    assert [a.name for a in record.artefacts] == ["force-1.mcap", "force-2.mcap"]
    data = await rig.archive.do(lambda store: store.artefacts.get(record.artefacts[1].sha256))
    recording = read_recording(data)
    assert recording.complete
    assert recording.facts["attempt"] == "2"
    assert len(recording.curve.time_s) == 80
    assert rig.recorder.force_peaks()[2] == pytest.approx(36.0)


def test_peaks_are_unknown_before_the_first_contact(rig: RunRig) -> None:
    assert np.isnan(rig.recorder.force_peaks()).all()


async def test_a_force_curve_is_dated_by_the_begin_of_its_contact(rig: RunRig) -> None:
    felt = curve(50)
    begun_s = now_s() - 30.0
    rig.recorder.mating_progress(ended(replace(felt, time_s=felt.time_s + begun_s)))
    await rig.recorder.force_curves()
    record = await rig.record()
    (artefact,) = (one for one in record.artefacts if one.name == "force-1.mcap")
    data = await rig.archive.do(lambda store: store.artefacts.get(artefact.sha256))
    first, *_, last = read_raw(data).messages
    assert artefact.time.timestamp() - first.time_ns / 1e9 == pytest.approx(30.0, abs=2.0)
    assert (last.time_ns - first.time_ns) / 1e9 == pytest.approx(0.049, abs=1e-6)


def test_a_picture_is_a_jpeg() -> None:
    data = draw(np.zeros((40, 60), np.uint8), PairMeasurement("default", ()), "left")
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (40 + INSET_PX, 60, 3)


async def test_raw_images_are_recorded_with_their_exposures(rig: RunRig) -> None:
    grey = np.zeros((4, 6), np.uint8)
    sides = [ExposureRecord(name, "Mono8", 8, exposure_s=0.004) for name in ("left", "right")]
    time_s = now_s()
    told = StereoPair(grey, grey, time_s, 1, tuple(sides))
    silent = StereoPair(grey, grey, time_s - 60.0, 1)
    found = replace(
        measurement(PLACE, PLACE, rig.bench.features()[0], SIGMA),
        predicted=PLACE,
        shots=((told, silent),),
    )
    ellipse = Ellipse(np.array([20.4, 10.2]), (6.0, 5.0), 0.3)
    hole = HoleMeasurement(
        name=found.pose.names[0], kind="pin",
        left_px=np.array([20.5, 10.25]), right_px=np.array([22.5, 10.25]),
        left_covariance_px2=np.eye(2) * 4e-4, right_covariance_px2=np.eye(2) * 9e-4,
        position_m=np.zeros(3), covariance_m2=np.eye(3) * 1e-12,
        left_ellipse=ellipse, right_ellipse=ellipse, diameter_m=6e-3, epipolar_px=0.01,
    )  # fmt: skip
    found = replace(found, heads=(PairMeasurement("default", (hole,)), found.heads[1]))
    await rig.recorder.measurement("frame", found)
    kept = (await rig.record()).document("images.exposures")
    files = [f"raw/frame-frame-1-head-1-{side}.pgm.zst" for side in ("left", "right")]
    assert {file: one["serial_number"] for file, one in kept.items()} == dict(
        zip(files, ("left", "right"), strict=True)
    )
    record = await rig.record()
    taken = taken_images(record)
    views = {"head-1-left", "head-1-right", "head-2-left", "head-2-right"}
    assert {one.view for one in taken.values()} == views
    apart = taken[files[0]].time - taken["raw/frame-frame-1-head-2-left.pgm.zst"].time
    assert apart.total_seconds() == pytest.approx(60.0, abs=1.0)
    rims = rims_of(record)
    assert set(rims) == {("frame", view) for view in views}
    (rim,) = rims["frame", "head-1-right"]
    assert rim.name == hole.name
    assert rim.centre_px == (22.5, 10.25)
    assert rim.sigma_px == pytest.approx((0.03, 0.03))
    assert rim.semi_axes_px == (6.0, 5.0)
    assert not rims["frame", "head-2-left"]
    assert rim.residual_um is not None
