"""What the methods say of one rendered image, against truth."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from cellctl.errors.base import CellError
from cellctl.geometry.pose import Array, pose_error
from cellctl.processes.antenna_module.vision.measure import measure_connector
from cellctl.processes.antenna_module.vision.measurement import ConnectorMeasurement
from cellctl.processes.antenna_module.vision.paper_method import measure_by_paper
from cellctl.processes.antenna_module.vision.planar_fit import fit_planar
from tests.rigs.antenna.pictures import Conditions, Trial, drawing, trial


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """One image by one method."""

    fault: str = ""
    """Class of the fault; empty for a measurement."""
    error: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """x, y (m) and yaw (rad) against truth, in the camera."""
    nees: float = 0.0
    bad: tuple[str, ...] = ()
    """Contacts that are not good."""
    faulty: tuple[str, ...] = ()
    """Those that really are not."""
    seconds: float = 0.0

    @property
    def distance_um(self) -> float:
        """Error of the place."""
        return float(np.hypot(self.error[0], self.error[1])) * 1e6


def both(seed: int, conditions: Conditions) -> tuple[Outcome, Outcome]:
    """One image by the default and by the paper's method."""
    given = trial(seed, conditions)
    default = outcome(
        given,
        lambda: measure_connector(
            given.pixels.plane, given.camera, given.plane, given.connector, given.marks
        ),
    )
    paper = outcome(
        given, lambda: measure_by_paper(given.pixels, given.camera, given.plane, given.connector)
    )
    return default, paper


def outcome(given: Trial, measure: Callable[[], ConnectorMeasurement]) -> Outcome:
    """What a method says, against truth."""
    begin = time.process_time()
    try:
        result = measure()
    except CellError as fault:
        return Outcome(fault=type(fault).__name__, faulty=given.faulty)
    seconds = time.process_time() - begin
    moved, turned = pose_error(given.truth, result.camera_T_connector.pose)
    error = np.array([moved[0], moved[1], turned[2]])
    free = np.ix_([0, 1, 5], [0, 1, 5])
    covariance = result.camera_T_connector.covariance[free]
    return Outcome(
        error=(float(error[0]), float(error[1]), float(error[2])),
        nees=float(error @ np.linalg.solve(covariance, error)),
        bad=tuple(sorted(c.name for c in result.contacts if c.state != "ok")),
        faulty=given.faulty,
        seconds=seconds,
    )


def refusal(seed: int, conditions: Conditions, change: str) -> str:
    """Class of the fault for a wrong image, file or calibration; "measured" without one."""
    given = trial(seed, conditions)
    image, camera, connector = given.pixels.plane, given.camera, given.connector
    if change == "mirror":
        image = np.ascontiguousarray(image[:, ::-1])
    elif change == "flip":
        image = np.ascontiguousarray(image[::-1])
    elif change == "file":
        other = "micro-d-15" if connector.name == "d-sub-15" else "d-sub-15"
        connector = drawing(other, connector.kind)
    elif change == "intrinsics":
        matrix = camera.model.camera_matrix + np.array([[0, 0, 1.0], [0, 0, 0], [0, 0, 0]])
        camera = replace(camera, model=replace(camera.model, camera_matrix=matrix))
    try:
        measure_connector(image, camera, given.plane, connector, given.marks)
    except CellError as fault:
        return type(fault).__name__
    return "measured"


def false_alarms(connectors: int) -> int:
    """Good connectors of which a contact is suspected; contacts drawn, without images."""
    connector = drawing("micro-d-15", "pins")
    count = len(connector.contacts)
    image = np.tile(np.eye(2) * (0.5e-6) ** 2, (count, 1, 1))
    rng = np.random.default_rng(20_134)
    suspected = 0
    for _ in range(connectors):
        places: Array = connector.positions_m + rng.normal(0.0, 10e-6, (count, 2))
        fit = fit_planar(connector.positions_m, places, image, connector.true_position_m)
        suspected += fit is None or not fit.used.all()
    return suspected


def quantiles(outcomes: Iterable[Outcome]) -> tuple[float, float]:
    """95 of 100 are below: place (µm), yaw (degrees)."""
    chosen = list(outcomes)
    if not chosen:
        return float("inf"), float("inf")
    yaws = [abs(float(np.degrees(item.error[2]))) for item in chosen]
    places = [item.distance_um for item in chosen]
    return float(np.quantile(places, 0.95)), float(np.quantile(yaws, 0.95))


def words(outcomes: list[Outcome]) -> str:
    """Figures of a method: root mean square per axis, p95, p99, greatest; yaw; refusals."""
    measured = [item for item in outcomes if not item.fault]
    refused = len(outcomes) - len(measured)
    tail = f"; {refused} refused" if refused else ""
    if not measured:
        return f"none{tail}"
    places = np.array([item.distance_um for item in measured])
    rms = float(np.sqrt((places**2).mean() / 2.0))
    p50, p95, p99 = np.quantile(places, [0.5, 0.95, 0.99])
    yaw = quantiles(measured)[1]
    return (
        f"rms {rms:.2f}, median {p50:.2f}, p95 {p95:.2f}, p99 {p99:.2f}, "
        f"max {places.max():.2f} µm; yaw p95 {yaw:.4f}°{tail}"
    )
