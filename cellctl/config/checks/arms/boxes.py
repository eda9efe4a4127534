"""Boxes of the flange that bound nothing, or that lead into an arm, a floor or a table.

Measured against how far an arm reaches by its links, and against where it has to come. No distance
here is that of a certain cell.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

import numpy as np

from cellctl.config.cell import CellConfig
from cellctl.config.checks.arms.needs import BOXES, ArmNeeds, BoxRoom, rooms
from cellctl.config.checks.arms.tables import described_arms
from cellctl.config.issue import ConfigIssue
from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.box import Box
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc

_COLUMN_M = (0.0, 1.0)
"""Stretch of the axis A1 over the foot of an arm that is body in every arm of this size."""
_BELOW_SHARE, _ASIDE_SHARE = 0.2, 0.75
"""Shares of the reach from the shoulder that a box may leave beyond all that has to lie in it:
little downwards, where tables, fixtures and parts are, and much elsewhere."""
_TURNED_DEG, _ROLLED_DEG = 120.0, 270.0
"""Room of joint limits beyond all stated joints: of the axes that place the wrist or bend it, and
of the two that roll."""
_ROLLING = (3, 5)
_FACES = ("-x", "-y", "-z", "+x", "+y", "+z")


def box_issues(
    cell: CellConfig, bases: Mapping[str, Sequence[float]], bad: Set[str]
) -> Iterator[ConfigIssue]:
    """Boxes that hold all that the arm reaches, or the base of another arm.

    ``bases`` is ``cell_T_base`` in its written form by robot, empty without a model of the cell;
    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for name, chain in described_arms(cell, bad).items():
        for key, lower_mm, upper_mm in _written_boxes(cell, name):
            if len(_unreached(chain, lower_mm, upper_mm)) == len(_FACES):
                allowed = "a box that bounds the flange; the arm reaches none of its faces"
                yield ConfigIssue(f"{key}_max_mm", str(upper_mm.tolist()), allowed)
                continue
            box = Box(lower_mm * MM, upper_mm * MM)
            for other in bases.keys() & cell.robots.keys() - {name}:
                if name in bases and box.meets(_column_m(bases[name], bases[other])):
                    allowed = (
                        f"a box beside robots.{other}, whose base stands in this one by the model "
                        "of the cell (cell_T_base)"
                    )
                    written = f"{lower_mm.tolist()} to {upper_mm.tolist()}"
                    yield ConfigIssue(f"{key}_max_mm", written, allowed)


def box_remarks(cell: CellConfig, needs: Iterable[ArmNeeds]) -> Iterator[ConfigIssue]:
    """Faces out of reach, boxes about the arm itself or far below its work, wide joint limits.

    ``needs`` are those of the cell's arms, by ``arm_needs``.
    """
    for of_arm in needs:
        for room in rooms(cell.robots[of_arm.name], of_arm):
            yield from _faces(of_arm, room)
            yield from _column(of_arm, room)
        yield from _joints(cell, of_arm)


def _faces(needs: ArmNeeds, room: BoxRoom) -> Iterator[ConfigIssue]:
    far_mm = _from_shoulder_mm(needs.chain)
    unreached = _unreached(needs.chain, room.lower_mm, room.upper_mm)
    left_mm = [*room.below_mm, *room.above_mm]
    for index, face in enumerate(_FACES):
        corner, values = ("min", room.lower_mm) if index < 3 else ("max", room.upper_mm)
        share = _BELOW_SHARE if face == "-z" else _ASIDE_SHARE
        if face in unreached:
            said = f"bounds nothing towards {face}, where the arm does not reach so far"
        elif face == "-z" and values[2] < 0.0:
            said = "below the plane on which the arm stands: right if it stands on a pedestal"
        elif left_mm[index] > share * far_mm:
            said = (
                f"towards {face} it leaves {left_mm[index]:.0f} mm beyond every taught pose and "
                f"stated move, more than {share:g} of the arm's reach: a slip moves the flange so "
                "far before anything refuses it"
            )
        else:
            continue
        yield ConfigIssue(f"{room.key}_{corner}_mm", str(values.tolist()), said)


def _column(needs: ArmNeeds, room: BoxRoom) -> Iterator[ConfigIssue]:
    """A box that comes nearer to A1 than the arm's own turret, over which its upper arm stands."""
    turret_m = needs.chain.dh[0, 2]
    nearest_mm = np.maximum(np.maximum(room.lower_mm, -room.upper_mm)[:2], 0.0)
    away_mm = float(np.linalg.norm(nearest_mm))
    if away_mm < abs(turret_m) / MM:
        said = (
            f"the box comes within {away_mm:.0f} mm of the axis A1, and the arm's own turret "
            f"reaches out to {abs(turret_m) / MM:.0f} mm: the box does not keep the tool out of it"
        )
        yield ConfigIssue(f"{room.key}_min_mm", str(room.lower_mm.tolist()), said)


def _joints(cell: CellConfig, needs: ArmNeeds) -> Iterator[ConfigIssue]:
    if not len(needs.joints_deg):
        return
    lower_deg, upper_deg = np.degrees(needs.chain.lower_rad), np.degrees(needs.chain.upper_rad)
    left = {
        "joints_min_deg": needs.joints_deg.min(axis=0) - lower_deg,
        "joints_max_deg": upper_deg - needs.joints_deg.max(axis=0),
    }
    for name, room_deg in left.items():
        written = cell.robots[needs.name].settings.get(name)
        for axis, one_deg in enumerate(room_deg):
            most_deg = _ROLLED_DEG if axis in _ROLLING else _TURNED_DEG
            if written is not None and one_deg > most_deg:
                said = (
                    f"A{axis + 1} may go {one_deg:.0f} deg beyond every stated joint: a limit so "
                    "wide refuses no slip, and the arm may be folded otherwise on the way"
                )
                yield ConfigIssue(f"robots.{needs.name}.settings.{name}", str(written), said)


def _written_boxes(cell: CellConfig, name: str) -> Iterator[tuple[str, Array, Array]]:
    settings = cell.robots[name].settings
    for box in BOXES:
        lower, upper = settings.get(f"{box}_min_mm"), settings.get(f"{box}_max_mm")
        if lower is not None and upper is not None:
            key = f"robots.{name}.settings.{box}"
            yield key, np.array(lower, float), np.array(upper, float)


def _unreached(chain: ArmChain, lower_mm: Array, upper_mm: Array) -> list[str]:
    """Faces to which the flange does not come: the shoulder goes about A1, the rest about it."""
    _, height_m, turret_m, twist = chain.dh[0]
    if abs(np.cos(twist)) > np.sin(np.radians(1.0)):
        return []  # A2 is not square to A1: not the kind of arm whose reach is so easily told
    far_mm = _from_shoulder_mm(chain)
    aside_mm, height_mm = abs(turret_m) / MM + far_mm, height_m / MM
    reach_mm = [aside_mm, aside_mm, far_mm - height_mm, aside_mm, aside_mm, far_mm + height_mm]
    out_mm = [*-lower_mm, *upper_mm]
    return [face for face, out, reach in zip(_FACES, out_mm, reach_mm, strict=True) if out >= reach]


def _from_shoulder_mm(chain: ArmChain) -> float:
    """Length of all links behind the axis A2."""
    return float(np.hypot(chain.dh[1:, 1], chain.dh[1:, 2]).sum()) / MM


def _column_m(base: Sequence[float], other: Sequence[float]) -> Array:
    """Both ends of the other arm's column in the base of the first one, shape (2, 3)."""
    base_T_other = pose_from_xyzabc(base).inv() * pose_from_xyzabc(other)
    return np.asarray(base_T_other.apply(np.outer(_COLUMN_M, [0.0, 0.0, 1.0])))
