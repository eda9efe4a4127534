"""One taught pose written into the text of a cell file; everything else stays as a person wrote it.

A library that reads and writes TOML would have to keep blanks and comments too. Here one line
changes, and the result is read again: it must say what it said before, and the new pose.
"""

import copy
import re
import tomllib
from collections.abc import Sequence
from typing import Any

from cellctl.errors.config import FileInvalid

_HEADER = re.compile(r"^\s*\[\[?([^\]]+)\]\]?\s*(?:#.*)?$")
_REMARK = re.compile(r"(?:;\s*)?taught \d{4}-\d{2}-\d{2}[^;]*")
"""What this module has written at an earlier time; the person's own words stay."""


def with_pose(
    text: str, robot: str, pose: str, joints_deg: Sequence[float], remark: str = ""
) -> str:
    """The text with joints in degrees under ``[robots.ROBOT.poses_deg]``.

    ``remark`` follows the comment of the line. Raises ``FileInvalid`` when the file has no such
    robot, or is written in a way in which the pose cannot be placed, such as an inline table.
    """
    before = _parsed(text)
    if robot not in before.get("robots", {}):
        raise FileInvalid(f"the cell file has no robot {robot!r}")
    lines = text.splitlines()
    numbers = _rounded(joints_deg)
    value = str(numbers)
    _place(lines, robot, pose, value, remark)
    changed = "\n".join(lines) + ("\n" if text.endswith("\n") or not text else "")
    expected = copy.deepcopy(before)
    expected["robots"][robot].setdefault("poses_deg", {})[pose] = numbers
    if _parsed(changed) != expected:
        raise FileInvalid(
            f"robots.{robot}.poses_deg.{pose} cannot be placed in this file; write it yourself: "
            f"{pose_line(pose, joints_deg)}"
        )
    return changed


def pose_line(pose: str, joints_deg: Sequence[float]) -> str:
    """Joints in degrees as a person would write them into the file."""
    return f"{pose} = {_rounded(joints_deg)}"


def _rounded(joints_deg: Sequence[float]) -> list[float]:
    return [round(float(angle), 5) + 0.0 for angle in joints_deg]


def _place(lines: list[str], robot: str, pose: str, value: str, remark: str) -> None:
    section = _section(lines, f"robots.{robot}.poses_deg")
    if section is None:
        owner = _section(lines, f"robots.{robot}")
        if owner is None:
            raise FileInvalid(f"the cell file has no section [robots.{robot}]")
        end = _last_written(lines, *owner)
        lines[end:end] = ["", f"[robots.{robot}.poses_deg]"]
        section = end + 2, end + 2
    first, last = section
    for number in range(first, last):
        if re.match(rf"^\s*(?:{pose}|\"{pose}\")\s*=", lines[number]):
            stop, comment = _value_end(lines, number)
            indent = lines[number][: len(lines[number]) - len(lines[number].lstrip())]
            lines[number:stop] = [indent + _line(pose, value, comment, remark)]
            return
    lines.insert(_last_written(lines, first, last), _line(pose, value, "", remark))


def _section(lines: list[str], name: str) -> tuple[int, int] | None:
    """First line of a table, and the line behind its last one."""
    start: int | None = None
    for number, line in enumerate(lines):
        found = _HEADER.match(line)
        if found is None:
            continue
        if start is not None:
            return start, number
        if re.sub(r"[\s\"]", "", found[1]) == name:
            start = number + 1
    return None if start is None else (start, len(lines))


def _last_written(lines: list[str], first: int, last: int) -> int:
    """The line behind the last one of a table that is neither blank nor a comment, since a comment
    there may belong to what follows."""
    while last > first and not lines[last - 1].partition("#")[0].strip():
        last -= 1
    return last


def _value_end(lines: list[str], number: int) -> tuple[int, str]:
    """The line behind an array that begins in a line, and the comment of its last line."""
    depth = 0
    for stop in range(number, len(lines)):
        code, _, comment = lines[stop].partition("#")
        depth += code.count("[") - code.count("]")
        if depth <= 0:
            return stop + 1, comment.strip()
    return len(lines), ""


def _line(pose: str, value: str, comment: str, remark: str) -> str:
    kept = _REMARK.sub("", comment).strip(" ;")
    words = "; ".join(part for part in (kept, remark) if part)
    return f"{pose} = {value}" + (f"   # {words}" if words else "")


def _parsed(text: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FileInvalid(f"cell file: {error}") from error
