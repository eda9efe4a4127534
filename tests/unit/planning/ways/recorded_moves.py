"""Commands of a recorded run beside the moves that its process states."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.stated.moves import MoveKind, StatedMove, StatedPlace
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.ways.polyline import polyline


def motions(record: Path) -> list[dict[str, Any]]:
    """What moved an arm, of the commands of a motion.mcap, a line of JSON each."""
    commands = [json.loads(line) for line in record.read_text(encoding="utf-8").splitlines()]
    return [one for one in commands if one["what"] in ("move_joint", "move_linear", "step")]


def covers(scene: CellScene, move: StatedMove, command: dict[str, Any], tolerance_m: float) -> bool:
    """Whether the target is one of the move, or between its ends, to the tolerance of the parts."""
    if command["what"] == "move_joint":
        if move.kind is not MoveKind.JOINT:
            return False
        # A stated way is commanded point by point.
        ends = polyline(scene.arms[move.robot], move)[1:]
        return bool(np.abs(ends - np.array(command["joints_rad"])).max(axis=1).min() < 1e-6)
    if move.kind is not MoveKind.LINEAR:
        return False
    target_m = pose_from_xyzabc(command["base_T_flange_mm_deg"]).translation
    start, end = (_flange(scene, move.robot, place).translation for place in (move.start, move.end))
    return bool(_off_line_m(target_m, start, end) <= tolerance_m)


def _flange(scene: CellScene, robot: str, place: StatedPlace) -> RigidTransform:
    if place.base_T_flange is not None:
        return place.base_T_flange
    return scene.arms[robot].base_T_flange(place.joints_rad)


def _off_line_m(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> float:
    way = end - start
    length = float(way @ way)
    # A tilt turns the flange about its own place.
    share = np.clip((point - start) @ way / length, 0.0, 1.0) if length else 0.0
    return float(np.linalg.norm(point - start - share * way))
