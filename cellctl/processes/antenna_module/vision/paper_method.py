"""The paper's image method as a named baseline.

Saturation finds the coloured connector: dynamic threshold, opening and dilation, screening of
contours. Under that mask green is sharpened, edges are found by Canny and placed to a fraction of a
pixel, circles are fitted to closed ones. The mean of the centres is the connector's place, the
least-squares line through them its angle. Source: the processing chain that the paper on the
automatic assembly of antenna modules describes for its connector of fifteen pins; sizes of filters
are not printed there and are chosen here by the contact's diameter.

Mean and line are right only with all contacts, so that any other number is refused. The line tells
nothing of half a turn; the trained place does.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.faults.connector import PaperMethodRefused
from cellctl.processes.antenna_module.vision.matching import rotation
from cellctl.processes.antenna_module.vision.measure import uncertain_pose
from cellctl.processes.antenna_module.vision.measurement import (
    ConnectorMeasurement,
    MeasuredContact,
)
from cellctl.processes.antenna_module.vision.pixels import MeasuredPixels
from cellctl.processes.antenna_module.vision.planar_fit import PlanarFit
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane, PlaneCalibration
from cellctl.vision.camera.image_checks import check_image
from cellctl.vision.camera.single_camera import SingleCamera

_OFFSET_GREY = 20.0
"""Saturation above that of the surroundings from which a pixel belongs to the connector."""
_SHARPEN = 1.0
_CANNY = (40.0, 110.0)
_SIZE = (0.7, 1.3)
"""Permitted radius of a circle, of a contact's."""
_ROUND = 0.10
"""Greatest scatter of the edge from its circle, of the radius."""
_ARC = 0.7
"""Least part of a circle that has edges."""


def measure_by_paper(
    pixels: MeasuredPixels,
    camera: SingleCamera,
    calibration: PlaneCalibration,
    connector: Connector,
) -> ConnectorMeasurement:
    """Mean and line of all contacts; raises ``PaperMethodRefused`` with any other number."""
    check_image(pixels.plane, camera.image_size, "image")
    plane = calibration.before(camera)
    if pixels.colour is None:
        raise PaperMethodRefused("the mask by saturation needs a colour image")
    middle = plane.from_px(np.array([camera.image_size], dtype=float) / 2.0)[0]
    px_m = plane.m_per_px(middle)
    radius_px = connector.diameter_m / 2.0 / px_m
    mask = _connector_mask(pixels.colour, connector, px_m)
    centres = _circles(pixels.plane, mask, radius_px)
    if len(centres) != len(connector.contacts):
        raise PaperMethodRefused(f"{len(centres)} circles, {len(connector.contacts)} contacts")
    points = plane.from_px(centres)
    fit = _mean_and_line(points, connector, _expected_yaw(plane, calibration))
    placed = connector.positions_m @ rotation(fit.yaw_rad).T + fit.shift_m
    order = np.linalg.norm(placed[:, None] - points[None], axis=2).argmin(axis=1)
    variance_px2 = (connector.true_position_m / px_m) ** 2
    contacts = tuple(
        MeasuredContact(
            name,
            "ok",
            centres[order[index]],
            variance_px2 * np.eye(2),
            rotation(fit.yaw_rad).T @ (points[order[index]] - placed[index]),
        )
        for index, name in enumerate(connector.contacts)
    )
    return ConnectorMeasurement(
        method="paper",
        connector=connector.name,
        camera_id=camera.id,
        contacts=contacts,
        radius_px=radius_px,
        camera_T_connector=uncertain_pose(plane, calibration, fit),
        scale=fit.scale,
        chi2=fit.chi2,
        freedom=fit.freedom,
        warnings=("the paper's method: a contact that is bent is not noticed",),
    )


def _connector_mask(
    colour: NDArray[np.uint8], connector: Connector, px_m: float
) -> NDArray[np.uint8]:
    """Filled outline of the saturated region that has the size of the connector."""
    saturation = cv2.cvtColor(colour, cv2.COLOR_BGR2HSV)[:, :, 1].astype(np.float32)
    smooth = cv2.GaussianBlur(saturation, (0, 0), 1.5)
    # Wider than the connector: its own saturation must not raise the threshold to itself.
    reach = 2 * round(max(connector.outline_m) / px_m) + 1
    ground = cv2.blur(smooth, (reach, reach), borderType=cv2.BORDER_REPLICATE)
    # Dark pixels have a saturation of noise.
    lit = cv2.GaussianBlur(colour.max(axis=2), (0, 0), 1.5) > 12
    binary = ((smooth > ground + _OFFSET_GREY) & lit).astype(np.uint8)
    size = 2 * max(round(connector.diameter_m / px_m / 4.0), 1) + 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    binary = np.asarray(cv2.dilate(cv2.morphologyEx(binary, cv2.MORPH_OPEN, kernel), kernel))
    contours, _ = cv2.findContours(binary, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    nominal_px2 = connector.outline_m[0] * connector.outline_m[1] / px_m**2
    fitting = [c for c in contours if 0.5 < cv2.contourArea(c) / nominal_px2 < 2.0]
    if not fitting:
        raise PaperMethodRefused("no saturated region has the size of the connector")
    mask = np.zeros(binary.shape, dtype=np.uint8)
    cv2.drawContours(mask, [max(fitting, key=cv2.contourArea)], -1, 255, cv2.FILLED)
    return mask


def _circles(green: Image, mask: NDArray[np.uint8], radius_px: float) -> Array:
    """Centres of circles of the right size among the edges under the mask, shape (n, 2)."""
    masked = np.where(mask > 0, green, 0).astype(np.float32)
    sharp = masked + _SHARPEN * (masked - cv2.GaussianBlur(masked, (0, 0), 2.0))
    sharp8 = np.clip(sharp, 0, 255).astype(np.uint8)
    edges = cv2.Canny(sharp8, *_CANNY, L2gradient=True)
    # The border of the mask is an edge, too, but not one of the connector.
    edges[cv2.erode(mask, np.ones((7, 7), dtype=np.uint8)) == 0] = 0
    contours, _ = cv2.findContours(edges, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    slope_x = cv2.Sobel(sharp, cv2.CV_32F, 1, 0)
    slope_y = cv2.Sobel(sharp, cv2.CV_32F, 0, 1)
    slope = np.hypot(slope_x, slope_y)
    found: list[Array] = []
    for contour in contours:
        points = contour[:, 0, :].astype(int)
        if len(points) < 8:
            continue
        circle = _circle(_subpixel(points, slope_x, slope_y, slope), radius_px)
        if circle is not None and all(np.hypot(*(circle - c)) > radius_px for c in found):
            found.append(circle)
    return np.array(found).reshape(-1, 2)


def _subpixel(points: NDArray[np.int_], gx: np.ndarray, gy: np.ndarray, slope: np.ndarray) -> Array:
    """Canny's pixels moved along the gradient to the top of the slope."""
    x, y = points.T
    height, width = slope.shape
    inner = (x > 1) & (y > 1) & (x < width - 2) & (y < height - 2)
    x, y = x[inner], y[inner]
    size = np.maximum(slope[y, x], 1e-6)
    ux, uy = gx[y, x] / size, gy[y, x] / size
    steps = [
        cv2.remap(
            slope,
            (x + k * ux).astype(np.float32).reshape(-1, 1),
            (y + k * uy).astype(np.float32).reshape(-1, 1),
            cv2.INTER_LINEAR,
        ).ravel()
        for k in (-1.0, 0.0, 1.0)
    ]
    low, middle, high = (step.astype(float) for step in steps)
    curve = np.minimum(low - 2.0 * middle + high, -1e-6)
    shift = np.clip(0.5 * (low - high) / curve, -1.0, 1.0)
    return np.column_stack([x + shift * ux, y + shift * uy])


def _circle(points: Array, radius_px: float) -> Array | None:
    """Algebraic least-squares circle; None unless it is one contact's."""
    if len(points) < 8:
        return None
    design = np.column_stack([2.0 * points, np.ones(len(points))])
    a, b, c = np.linalg.lstsq(design, (points**2).sum(axis=1), rcond=None)[0]
    square = c + a * a + b * b
    if square <= 0:
        return None
    radius = float(np.sqrt(square))
    centre = np.array([a, b])
    offset = points - centre
    scatter = float(np.std(np.hypot(*offset.T)))
    sectors = np.unique(np.floor((np.arctan2(*offset.T) / (2.0 * np.pi) + 0.5) * 24.0))
    good = _SIZE[0] < radius / radius_px < _SIZE[1] and scatter < _ROUND * radius
    return centre if good and len(sectors) >= _ARC * 24 else None


def _expected_yaw(plane: MeasuringPlane, calibration: PlaneCalibration) -> float:
    if calibration.expected is None:
        return 0.0
    pose = plane.camera_T_plane.inv() * calibration.expected.camera_T_connector
    along = pose.rotation.as_matrix()[:2, 0]
    return float(np.arctan2(along[1], along[0]))


def _mean_and_line(points: Array, connector: Connector, expected_yaw: float) -> PlanarFit:
    """Place and angle as the paper computes them, in the form of the default's fit."""
    mean = points.mean(axis=0)
    yaw = _line_angle(points) - _line_angle(connector.positions_m)
    # The line has no direction; the trained place says which of the two it is.
    turns = round((expected_yaw - yaw) / np.pi)
    yaw += turns * np.pi
    shift = mean - rotation(yaw) @ connector.positions_m.mean(axis=0)
    along = (points - mean) @ rotation(yaw)
    count = len(points)
    # As the two estimates are made: scatter of the mean, scatter about the line over its length.
    sigma_m = connector.true_position_m / np.sqrt(count)
    sigma_yaw = connector.true_position_m / float(np.sqrt((along[:, 0] ** 2).sum()))
    return PlanarFit(
        yaw_rad=yaw,
        shift_m=shift,
        covariance=np.diag([sigma_m**2, sigma_m**2, sigma_yaw**2]),
        residuals_m=along,
        used=np.ones(count, dtype=bool),
        scale=float(np.std(along[:, 0]) / np.std(connector.positions_m[:, 0])),
        scale_sigma=0.0,
        chi2=0.0,
        freedom=0,
    )


def _line_angle(points: Array) -> float:
    """Angle of the total least-squares line."""
    offset = points - points.mean(axis=0)
    xx, yy = (offset**2).sum(axis=0)
    xy = float((offset[:, 0] * offset[:, 1]).sum())
    return float(0.5 * np.arctan2(2.0 * xy, xx - yy))
