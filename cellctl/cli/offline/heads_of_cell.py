"""Holds the heads of a board transfer against where a cell file and its model have them.

Which of two small heads is I nothing in a file of readings can tell: the cell file has their arms.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config import load_cell
from cellctl.config.cell import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.config.model_file import stated_bases
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM, pose_from_xyzabc

_MEASURING = "measuring"
_HEADS = ("head_1", "head_2")
"""Names of the heads in the file, and by default in the cell."""
_FAR_MM = 300.0
"""Between a place that was measured and that of drawings; the bases of arms stand nearer to theirs.
"""


def compare_heads(
    file: Path,
    cell_file: Path,
    measured: Mapping[str, RigidTransform],
    if_inverted: Mapping[str, RigidTransform],
) -> str | None:
    """Why nothing could be compared; None where both heads are where the cell has them.

    ``measured`` is base_T_camera by head, ``if_inverted`` the same for a c_T_base that was written
    as base_T_c. Raises ``FileInvalid`` for heads that are exchanged or elsewhere, and for an
    inverted base.
    """
    cell = load_cell(cell_file)
    drawn = _drawn(cell, cell_file)
    if drawn is None:
        return (
            f"{cell_file} does not say where its heads are: needed are {_HEADS[0]} and {_HEADS[1]} "
            f"with flange_T_camera, the pose {_MEASURING} and the dh table of their arms, and a "
            "model of the cell"
        )
    first, second = _HEADS
    far = {name: _apart_mm(measured[name], drawn[name]) for name in _HEADS}
    otherwise_mm = max(_apart_mm(if_inverted[name], drawn[name]) for name in _HEADS)
    if max(far.values()) > _FAR_MM >= otherwise_mm:
        raise FileInvalid(
            f"{file}: c_T_base is inverted (base_T_c)? By {cell_file} {first} and {second} are "
            f"{far[first]:.0f} and {far[second]:.0f} mm from where they were measured, with its "
            f"inverse at most {otherwise_mm:.0f} mm"
        )
    pairs = ((first, second), (second, first))
    crossed = max(_apart_mm(measured[one], drawn[other]) for one, other in pairs)
    if crossed < max(far.values()) / 2.0:
        raise FileInvalid(
            f"{file}: {first} and {second} are exchanged? By {cell_file} they are {far[first]:.0f} "
            f"and {far[second]:.0f} mm from where they were measured, exchanged at most "
            f"{crossed:.0f} mm"
        )
    for name, away_mm in far.items():
        if away_mm > _FAR_MM:
            raise FileInvalid(
                f"{file}: {name} was measured {away_mm:.0f} mm from where {cell_file} and its "
                "model have it: is c_T_base of this robot, and was its arm at the pose "
                f"{_MEASURING}?"
            )
    return None


def _drawn(cell: CellConfig, cell_file: Path) -> dict[str, RigidTransform] | None:
    """base_T_camera of both heads by the drawings, in the base of the arm without a head."""
    heads = {name: cell.stereo_cameras.get(name) for name in _HEADS}
    carriers = {head.carried_by for head in heads.values() if head is not None}
    others = [name for name in cell.robots if name not in carriers]
    bases = stated_bases(cell_file)
    if len(others) != 1 or others[0] not in bases:
        return None
    base_T_cell = pose_from_xyzabc(bases[others[0]]).inv()
    places = {}
    for name, head in heads.items():
        if head is None or head.flange_T_camera is None or head.carried_by is None:
            return None
        arm, cell_T_base = cell.robots[head.carried_by], bases.get(head.carried_by)
        driver, settings = robot_driver(arm)
        kinematics = driver.forward_kinematics(settings)
        if cell_T_base is None or kinematics is None or _MEASURING not in arm.poses_deg:
            return None
        arm_T_flange = kinematics(np.radians(arm.poses_deg[_MEASURING]))
        cell_T_arm = pose_from_xyzabc(cell_T_base)
        flange_T_camera = pose_from_xyzabc(head.flange_T_camera)
        places[name] = base_T_cell * cell_T_arm * arm_T_flange * flange_T_camera
    return places


def _apart_mm(one: RigidTransform, other: RigidTransform) -> float:
    return float(np.linalg.norm(one.translation - other.translation)) / MM
