"""Pegs and holes of the reference cases, and an arm that pushes them."""

import math

import numpy as np

from fakes.world.frames import Array
from fakes.world.peg.attitude import Pose6, axis_of
from fakes.world.peg.fit import Fit
from fakes.world.peg.held_peg import HeldPeg

MM = 1e-3


def pin(clearance_mm: float, chamfer_mm: float = 0.5, *, normal_n_m: float = 2e7) -> Fit:
    """A precision pin of 6 mm in a plate."""
    return Fit(
        3.0 * MM,
        (3.0 + clearance_mm) * MM,
        12.0 * MM,
        chamfer_mm * MM,
        chamfer_mm * MM,
        normal_n_m=normal_n_m,
    )


def plug(clearance_mm: float = 0.15) -> Fit:
    """A plug of a connector with an outer face, without its contacts and keys."""
    radius = 14.0 * MM
    return Fit(
        radius,
        radius + clearance_mm * MM,
        10.0 * MM,
        0.3 * MM,
        0.3 * MM,
        outer_radius_m=16.5 * MM,
        proud_m=12.0 * MM,
    )


def arm(lateral_n_m: float, axial_n_m: float = 1e6, turning_nm_rad: float = 5e4) -> Array:
    """Stiffness of what holds the peg, shape (6, 6)."""
    return np.diag([lateral_n_m] * 2 + [axial_n_m] + [turning_nm_rad] * 3)


def lowered(
    peg: HeldPeg, to_m: float, *, step_m: float = 5e-6, x_m: float = 0.0, tilt_rad: float = 0.0
) -> Array:
    """Push straight down to a commanded height; rows of depth (m) and wrench on the peg."""
    start_m = peg.commanded[2]
    rows = []
    for number in range(1, math.ceil((start_m - to_m) / step_m) + 1):
        peg.follow((x_m, 0.0, start_m - number * step_m, 0.0, tilt_rad, 0.0), 1e-3)
        rows.append([-peg.pose[2], *peg.wrench])
    return np.array(rows)


def above(
    fit: Fit,
    robot_n_m: Array,
    *,
    height_m: float = 0.1 * MM,
    x_m: float = 0.0,
    tilt_rad: float = 0.0,
    grip_n: float = math.inf,
) -> HeldPeg:
    """A peg over the hole that touches nothing yet."""
    return HeldPeg(fit, robot_n_m, (x_m, 0.0, height_m, 0.0, tilt_rad, 0.0), grip_n=grip_n)


def at_depth(rows: Array, depth_mm: float) -> Array:
    """Wrench at a depth."""
    return np.asarray(rows[np.abs(rows[:, 0] - depth_mm * MM).argmin(), 1:])


def reach_into_plate_m(fit: Fit, pose: Pose6) -> float:
    """How deep the surface of the peg reaches into plate or plug (m), by its points."""
    s = np.array(axis_of(pose[3], pose[4]))
    a = np.array([s[2], 0.0, -s[0]]) / math.hypot(s[0], s[2])
    turn = np.linspace(0, 2 * np.pi, 721)
    ring = np.outer(a, np.cos(turn)) + np.outer(np.cross(s, a), np.sin(turn))
    chamfer = np.linspace(0.0, fit.peg_chamfer_m, 12)
    deepest = -math.inf
    for up in [*chamfer, *np.linspace(fit.peg_chamfer_m, 4 * MM, 25)]:
        radius = fit.rim_radius_m + min(up, fit.peg_chamfer_m)
        x, y, z = np.array(pose[:3])[:, None] + up * s[:, None] + radius * ring
        rho = np.hypot(x, y)
        inside = np.minimum.reduce(
            [
                -z,
                rho - fit.bore_radius_m,
                (rho - fit.mouth_radius_m - z) * math.sqrt(0.5),
                fit.outer_radius_m - rho,
            ]
        )
        deepest = max(deepest, float(inside.max()))
    return deepest
