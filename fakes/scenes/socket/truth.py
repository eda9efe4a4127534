"""What nobody in the cell knows exactly, as the control port tells it."""

import math
from typing import TYPE_CHECKING, Any

from fakes.world.frames import MM, to_written

if TYPE_CHECKING:
    from fakes.scenes.socket.scene import SocketScene

_SEAT_MM = 0.3
"""A peg that is nearer to its seat than this is in."""
_HOLE_FAULTS = ("hole_absent", "wrong_hole", "wrong_size", "blocked")


def truth_of(world: "SocketScene") -> dict[str, Any]:
    """Poses, depth, verdict, slip and forces in mm, degrees, N and N·m."""
    peg, part = world.peg, world.part
    x, y, z, tilt_x, tilt_y, yaw = peg.pose
    wanted = world.nominal_fit
    # Beside the mouth the tip may hang below the face of a plug without being in anything.
    within = math.hypot(x, y) < peg.fit.mouth_radius_m
    depth_mm = -z / MM if within else 0.0
    wrong = [name for name in _HOLE_FAULTS if world.faults.active(name)]
    # The depth is that of the hole that was wanted: a peg deep in a wrong one is not seated.
    seated = within and depth_mm > wanted.depth_m / MM - _SEAT_MM and not wrong
    return {
        "load": world.loads,
        "cell_T_flange_mm_deg": to_written(world.flange(world.scenario.peg.carried_by)),
        "cell_T_hole_mm_deg": to_written(part.cell_T_hole),
        "flange_T_peg_mm_deg": to_written(part.flange_T_peg),
        "hole_T_tip_mm": [x / MM, y / MM, z / MM],
        "tilt_deg": math.degrees(math.hypot(tilt_x, tilt_y)),
        "yaw_deg": math.degrees(yaw),
        "depth_mm": depth_mm,
        "seat_depth_mm": wanted.depth_m / MM,
        "seated": seated,
        "hole_faults": wrong,
        "slip_mm": peg.slip_m / MM,
        "touching": bool(peg.touching),
        "force_n": peg.wrench.tolist(),
        "peak_force_n": _by_window(world.peaks.force_n),
        "peak_moment_nm": _by_window(world.peaks.moment_nm),
        "unsolved_steps": peg.failures,
        "unsolved_percent": 100.0 * peg.unsolved_share,
    }


def _by_window(peaks: dict[int, float]) -> dict[str, float]:
    return {f"{window}_ms": value for window, value in peaks.items()}
