"""Insertion curves of simple shape: what a judge must tell apart."""

import io
from dataclasses import dataclass

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.insertion.curve import COLUMNS, InsertionCurve


@dataclass(frozen=True, slots=True)
class Shape:
    """One insertion at 0.4 mm/s, sampled with 250 Hz."""

    peak_n: float = 24.0
    spring_mm: float = 0.5
    seat_mm: float = 2.5
    seat_n_per_mm: float = 300.0
    end_n: float = 20.0
    """Above the sliding force, where the drive stops."""
    pin_n_per_mm: float = 0.0
    """Stiffness of a pin that stands on the face."""
    pin_mm: tuple[float, float] = (0.0, 0.0)
    side_n: float = 0.0
    """Side force in entry and after."""
    axial_per_side: float = 0.2
    moment_z_n_m: float = 0.0
    drift_n: float = 0.0
    """A hose that pulls steadily."""
    noise_n: float = 0.05
    noise_n_m: float = 0.002


def curve(shape: Shape = Shape(), seed: int = 1) -> InsertionCurve:
    """The samples."""
    rng = np.random.default_rng(seed)
    stop_mm = shape.seat_mm + shape.end_n / shape.seat_n_per_mm
    z = np.arange(-1.0, stop_mm, 0.4 / 250)
    force, moment = np.zeros((len(z), 3)), np.zeros((len(z), 3))
    spring = shape.spring_mm
    rise = np.interp(
        z, [spring, spring + 0.4, spring + 1.1], [0.0, shape.peak_n, 0.7 * shape.peak_n]
    )
    seat = shape.seat_n_per_mm * np.clip(z - shape.seat_mm, 0, None)
    pin = np.where(z < spring, shape.pin_n_per_mm * np.clip(z, 0, None), 0.0)
    in_wall = np.clip(z / 0.25, 0, 1)
    force[:, 0] = shape.side_n * in_wall
    force[:, 2] = rise + seat + pin + shape.axial_per_side * shape.side_n * in_wall + shape.drift_n
    x_m, y_m = np.array(shape.pin_mm) * 1e-3
    moment[:, 0], moment[:, 1] = y_m * pin, -x_m * pin
    moment[:, 2] = shape.moment_z_n_m * in_wall
    force += rng.normal(0, shape.noise_n, force.shape)
    moment += rng.normal(0, shape.noise_n_m, moment.shape)
    return InsertionCurve(np.arange(len(z)) / 250, z * 1e-3, force, moment)


def as_csv(one: InsertionCurve) -> str:
    """The file."""
    table: Array = np.column_stack([one.t_s, one.depth_m * 1e3, one.force_n, one.moment_n_m])
    text = io.StringIO()
    text.write(",".join(COLUMNS) + "\n")
    np.savetxt(text, table, delimiter=",", fmt="%.6f")
    return text.getvalue()
