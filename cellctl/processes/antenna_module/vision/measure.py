"""Measures a connector, and the gripper's marks, in one image: the entrance of this package."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import MM
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.connector.marks import Marks
from cellctl.processes.antenna_module.faults.connector import (
    ConnectorAmbiguous,
    ConnectorMissing,
    ConnectorUncertain,
    PlaneScaleWrong,
    WrongConnector,
)
from cellctl.processes.antenna_module.vision.choice import (
    PlanarExpectation,
    choose,
    refuse_mirrored,
)
from cellctl.processes.antenna_module.vision.contact_states import contact_states
from cellctl.processes.antenna_module.vision.matching import looks_alike_in_mirror
from cellctl.processes.antenna_module.vision.measurement import (
    ConnectorMeasurement,
    MeasuredMarks,
)
from cellctl.processes.antenna_module.vision.one_sided_light import require_light_from_all_sides
from cellctl.processes.antenna_module.vision.other_sizes import (
    missing_marks,
    spots_of_another_size,
)
from cellctl.processes.antenna_module.vision.pattern import (
    Candidates,
    Pattern,
    find_pattern,
    fit_pattern,
    surplus,
)
from cellctl.processes.antenna_module.vision.planar_fit import PlanarFit
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane, PlaneCalibration
from cellctl.vision.camera.image_checks import check_image
from cellctl.vision.camera.single_camera import SingleCamera

SIGMA_LIMIT_M, YAW_LIMIT_RAD = 3e-6, float(np.radians(0.02))
"""Largest standard deviations with which a look counts as certain: of a place in the plane, each
axis, and of a turn about its normal."""
_LEAST_SHARE = 0.6
"""Share of the contacts that must be found and clean for the connector to count as this one; the
others may then be named as missing, bent or hidden."""
_SCALE_LIMIT = 5.0
"""Deviation of the pattern's scale from that of its plane, in standard deviations of both."""
_SURPLUS = 2
"""Contacts more than drawn from which it is another connector."""
_CONTACT_REACH = 0.35
"""How far a contact is looked for, over the least distance of two contacts: bent ones count, the
next one does not."""
_MARK_REACH = 0.25
"""How far a mark is looked for, over its diameter: marks do not bend."""
_MARK_TRUE_POSITION_M = 5e-6
"""How far a mark is off its place on the gripper, standard deviation."""
_BORE_SEEN_M, _BORE_SIGMA_M = 0.25e-3, 0.1e-3
"""By how much deeper than it is the rim of a bore appears to lie, and the standard deviation of
that. The far wall below the rim is lit and is taken for a part of the funnel, and blur mixes the
rim with the funnel's mouth, which is nearer to the camera. Found on rendered sockets of both kinds
at 20 to 35 µm a pixel: 0.16 to 0.42 mm, and 0.10 to 0.17 mm where next to no light gets into the
bores."""


def measure_connector(
    image: Image,
    camera: SingleCamera,
    calibration: PlaneCalibration,
    connector: Connector,
    marks: Marks | None = None,
) -> ConnectorMeasurement:
    """Measure the contacts of one connector; faults of 46x–47x where that cannot be trusted.

    Contacts that are missing, bent or hidden do not raise here, ``require_sound`` judges them.
    """
    # Where the connector may be: the marks of the gripper, if there are any, say it best.
    check_image(image, camera.image_size, "image")
    plane = calibration.before(camera)
    seen_marks = None if marks is None else _marks_in(image, plane, calibration, marks)
    expected = _expectation(plane, calibration, marks, seen_marks)
    # Whether it is this connector at all, and not its mirror image. Nothing is measured before
    # that: a fit to the wrong contacts may be a good one.
    rim_plane = plane.at_height(-seen_depth_m(connector))
    pattern = contact_pattern(connector)
    least = int(np.ceil(_LEAST_SHARE * len(pattern.names)))
    candidates = find_pattern(image, rim_plane, pattern, least=least)
    refuse_mirrored(pattern, candidates, least)
    _require_connector(image, rim_plane, pattern, candidates, least)
    if connector.symmetric and expected is None:
        raise ConnectorAmbiguous("the drawing looks the same after half a turn")
    seen = _as_seen(calibration, connector)
    extra = surplus(image, rim_plane, pattern, candidates, connector.outline_m)
    if extra >= _SURPLUS:
        raise WrongConnector(f"{extra} more contacts than the file has")
    # Which way round it lies, and the measurement itself.
    placement = choose(candidates, expected, chiral=False)
    found = fit_pattern(image, rim_plane, pattern, placement, candidates.spots_m)
    if found is None or np.count_nonzero(found.fit.used) < least:
        raise WrongConnector(f"fewer than {least} contacts are clean and in their places")
    # What makes a measurement wrong although it looks good: light from one side moves all rims
    # alike, and a wrong height shows in the scale.
    rims = [
        feature.circle
        for feature, used in zip(found.features, found.fit.used, strict=True)
        if used and feature.circle is not None
    ]
    require_light_from_all_sides(image, rim_plane, connector, rims)
    _require_scale(found.fit, plane, seen)
    require_certain(found.fit)
    contacts = contact_states(found, pattern, rim_plane)
    radius_px = pattern.diameter_m / 2.0 / rim_plane.m_per_px(found.fit.shift_m)
    return ConnectorMeasurement(
        method="default",
        connector=connector.name,
        camera_id=camera.id,
        contacts=contacts,
        radius_px=radius_px,
        camera_T_connector=uncertain_pose(plane, seen, found.fit),
        scale=found.fit.scale,
        chi2=found.fit.chi2,
        freedom=found.fit.freedom,
        marks=seen_marks,
        warnings=_warnings(connector, expected),
    )


def seen_depth_m(connector: Connector) -> float:
    """Depth below the face of the plane in which the borders of the contacts appear."""
    deeper_m = _BORE_SEEN_M if connector.kind == "holes" else 0.0
    return connector.rim_depth_m + deeper_m


def measure_marks(
    image: Image, camera: SingleCamera, calibration: PlaneCalibration, marks: Marks
) -> MeasuredMarks:
    """Measure the marks of a drawing without a connector between them.

    The plane is that of the connector that they belong to. Raises ``MarksMissing``,
    ``ImageMirrored``, ``ConnectorAmbiguous`` and the faults of unusable images.
    """
    check_image(image, camera.image_size, "image")
    return _marks_in(image, calibration.before(camera), calibration, marks)


def contact_pattern(connector: Connector) -> Pattern:
    """The contacts as a pattern of round features."""
    pins = connector.kind == "pins"
    return Pattern(
        names=connector.contacts,
        positions_m=connector.positions_m,
        diameter_m=connector.diameter_m,
        true_position_m=connector.true_position_m,
        reach_m=_CONTACT_REACH * connector.least_spacing_m,
        bright=pins,
        chamfer_m=connector.chamfer_m,
        length_m=connector.length_m - connector.rim_depth_m,
    )


def uncertain_pose(
    plane: MeasuringPlane, calibration: PlaneCalibration, fit: PlanarFit
) -> UncertainPose:
    """``camera_T_drawing``: x, y, yaw of the fit, height and tilt of the plane, each with its
    standard deviation."""
    turn = Rotation.from_rotvec([0.0, 0.0, fit.yaw_rad])
    place = RigidTransform.from_components(np.append(fit.shift_m, 0.0), turn)
    pose = plane.camera_T_plane * place
    axes = plane.camera_T_plane.rotation.as_matrix()
    by_fit = np.zeros((6, 3))
    by_fit[:3, :2], by_fit[3:, 2] = axes[:, :2], axes[:, 2]
    # A plane at another height moves the connector along the camera's ray to it.
    by_height = np.append(pose.translation / (axes[:, 2] @ pose.translation), np.zeros(3))
    by_tilt = np.zeros((6, 2))
    by_tilt[3:] = axes[:, :2]
    covariance = (
        by_fit @ fit.covariance @ by_fit.T
        + np.outer(by_height, by_height) * calibration.sigma_height_m**2
        + by_tilt @ by_tilt.T * calibration.sigma_tilt_rad**2
    )
    return UncertainPose(pose, covariance)


def _as_seen(calibration: PlaneCalibration, connector: Connector) -> PlaneCalibration:
    """The calibration with a height that is as uncertain as the depth at which a bore is seen."""
    if connector.kind == "pins":
        return calibration
    sigma_m = float(np.hypot(calibration.sigma_height_m, _BORE_SIGMA_M))
    return replace(calibration, sigma_height_m=sigma_m)


def _marks_in(
    image: Image, plane: MeasuringPlane, calibration: PlaneCalibration, marks: Marks
) -> MeasuredMarks:
    pattern = Pattern(
        names=marks.names,
        positions_m=marks.positions_m,
        diameter_m=marks.diameter_m,
        true_position_m=_mark_sigma_m(plane, calibration, marks),
        reach_m=_MARK_REACH * marks.diameter_m,
        bright=marks.bright,
    )
    raised = plane.at_height(marks.height_m)
    # One mark may be dirty. Those that are left must still tell every way apart, which the choice
    # among the placements shows.
    least = max(len(marks.names) - 1, 3)
    candidates = find_pattern(image, raised, pattern, least=least, chiral=True)
    if not candidates.placements and not candidates.mirrored:
        raise missing_marks(image, raised, pattern, candidates, least)
    placement = choose(candidates, None, chiral=True)
    found = fit_pattern(image, raised, pattern, placement, candidates.spots_m)
    if found is None or np.count_nonzero(found.fit.used) < least:
        raise missing_marks(image, raised, pattern, candidates, least)
    circles = [feature.circle for feature in found.features if feature.circle is not None]
    px = raised.to_px(np.array([circle.centre_m for circle in circles]))
    radius_px = marks.diameter_m / 2.0 / raised.m_per_px(found.fit.shift_m)
    pose = uncertain_pose(raised, calibration, found.fit)
    return MeasuredMarks(pose, px, radius_px, found.fit.scale)


def _mark_sigma_m(plane: MeasuringPlane, calibration: PlaneCalibration, marks: Marks) -> float:
    """How far a good mark may be off its place, standard deviation.

    Marks lie far apart: a plane whose height is wrong by 0.2 mm moves those at its ends by 20 µm
    along their rays, which is no fault of theirs.
    """
    reach_m = float(np.linalg.norm(marks.positions_m, axis=1).max())
    height_m = float(np.hypot(calibration.sigma_height_m, reach_m * calibration.sigma_tilt_rad))
    along_m = height_m * reach_m / float(plane.camera_T_plane.translation[2])
    return float(np.hypot(_MARK_TRUE_POSITION_M, along_m))


def _expectation(
    plane: MeasuringPlane,
    calibration: PlaneCalibration,
    marks: Marks | None,
    seen: MeasuredMarks | None,
) -> PlanarExpectation | None:
    """The expected place by the marks where they are seen, otherwise by the trained place."""
    if marks is not None and seen is not None:
        pose = seen.camera_T_marks.pose * marks.marks_T_connector
        within = (marks.within_m, marks.within_rad)
    elif calibration.expected is not None:
        pose = calibration.expected.camera_T_connector
        within = (calibration.expected.within_m, calibration.expected.within_rad)
    else:
        return None
    in_plane = plane.camera_T_plane.inv() * pose
    along = in_plane.rotation.as_matrix()[:2, 0]
    yaw = float(np.arctan2(along[1], along[0]))
    return PlanarExpectation(in_plane.translation[:2], yaw, *within)


def _require_connector(
    image: Image, plane: MeasuringPlane, pattern: Pattern, candidates: Candidates, least: int
) -> None:
    """``ConnectorMissing`` or ``WrongConnector`` where no placement has enough contacts."""
    if candidates.placements:
        return
    count = len(candidates.spots.px)
    if count >= least:
        raise WrongConnector(f"{count} spots of this size, in another arrangement")
    if (other := spots_of_another_size(image, plane, pattern, least)) is not None:
        raise WrongConnector(other)
    raise ConnectorMissing(f"{len(candidates.spots.px)} spots, {least} contacts needed")


def _require_scale(fit: PlanarFit, plane: MeasuringPlane, calibration: PlaneCalibration) -> None:
    distance_m = float(plane.camera_T_plane.translation[2])
    sigma = float(np.hypot(fit.scale_sigma, calibration.sigma_height_m / distance_m))
    # Here and below written so that what is not a number is refused too.
    if not abs(fit.scale - 1.0) <= _SCALE_LIMIT * sigma:
        raise PlaneScaleWrong(
            f"scale {fit.scale:.5f}, expected 1 ± {_SCALE_LIMIT * sigma:.5f}; as if the plane were "
            f"{(1.0 / fit.scale - 1.0) * distance_m / MM:+.2f} mm farther away"
        )


def require_certain(fit: PlanarFit) -> None:
    """Raise ``ConnectorUncertain`` unless all standard deviations are known and small enough."""
    with np.errstate(invalid="ignore"):
        x, y, yaw = np.sqrt(np.diag(fit.covariance))
    if not (x <= SIGMA_LIMIT_M and y <= SIGMA_LIMIT_M and yaw <= YAW_LIMIT_RAD):
        raise ConnectorUncertain(
            f"standard deviations {x * 1e6:.1f}, {y * 1e6:.1f} µm, {np.degrees(yaw):.3f}°"
        )


def _warnings(connector: Connector, expected: PlanarExpectation | None) -> tuple[str, ...]:
    if expected is not None or not looks_alike_in_mirror(connector):
        return ()
    return ("neither marks nor an expected place: a mirrored image would not be noticed",)
