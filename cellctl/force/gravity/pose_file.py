"""Still poses and their wrenches, read from the text of a CSV file.

Columns, in any order: ``qx,qy,qz,qw`` of base_T_sensor, ``fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm`` in
sensor axes, and optionally ``role`` (``fit``, ``hold-out`` or ``repeat``; ``fit`` if absent).
"""

import csv
import io
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from cellctl.errors.force import PayloadFileInvalid
from cellctl.force.gravity.poses import PoseRole
from cellctl.geometry.pose import Array

QUATERNION = ("qx", "qy", "qz", "qw")
WRENCH = ("fx_n", "fy_n", "fz_n", "mx_nm", "my_nm", "mz_nm")
ROLE = "role"
NORM_TOLERANCE = 1e-2
"""A quaternion whose length is further from 1 is refused: its columns probably hold something else,
such as angles."""


@dataclass(frozen=True, slots=True, eq=False)
class PoseRecord:
    """n still poses and the mean wrench at each."""

    base_R_sensor: Rotation
    """n rotations, stacked."""
    wrenches: Array
    """Shape (n, 6), N and N·m, sensor axes."""
    roles: tuple[PoseRole, ...]

    def having(self, role: PoseRole) -> "PoseRecord":
        """The poses of one role, possibly none."""
        index = np.array([i for i, own in enumerate(self.roles) if own is role], dtype=int)
        rotations = Rotation.from_quat(self.base_R_sensor.as_quat()[index].reshape(-1, 4))
        return PoseRecord(rotations, self.wrenches[index], (role,) * len(index))


def parse_pose_file(text: str) -> PoseRecord:
    """Read the text of a file; raises ``PayloadFileInvalid`` naming line and column."""
    # Spreadsheet programs write a byte order mark, which would become a part of the first column's
    # name.
    written = text.lstrip("\ufeff").splitlines()
    # The reader counts only what it is given, so each line keeps its number in the file.
    numbered = [(n, line) for n, line in enumerate(written, 1) if not line.startswith("#")]
    content = "\n".join(line for _, line in numbered)
    reader = csv.DictReader(io.StringIO(content), strict=True, skipinitialspace=True)
    try:
        _require_columns(reader.fieldnames)
        rows = [(numbered[reader.line_num - 1][0], row) for row in reader]
    except csv.Error as error:
        raise PayloadFileInvalid(f"not a CSV file: {error}") from error
    if not rows:
        raise PayloadFileInvalid("no line of data below the header")
    quaternions = np.array([_numbers(row, QUATERNION, number) for number, row in rows])
    wrenches = np.array([_numbers(row, WRENCH, number) for number, row in rows])
    _require_unit(quaternions, [number for number, _ in rows])
    roles = tuple(_role(row, number) for number, row in rows)
    return PoseRecord(Rotation.from_quat(quaternions), wrenches, roles)


def _require_columns(found: object) -> None:
    names = [str(name).strip() for name in found] if isinstance(found, (list, tuple)) else []
    if not names:
        raise PayloadFileInvalid("the file is empty")
    if len(names) == 1 and ";" in names[0]:
        raise PayloadFileInvalid(
            "the columns are separated by ';': save the file with commas between the columns and "
            "points in the numbers"
        )
    missing = [name for name in (*QUATERNION, *WRENCH) if name not in names]
    if missing:
        raise PayloadFileInvalid(f"missing column {', '.join(missing)}; found {', '.join(names)}")
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise PayloadFileInvalid(f"column {', '.join(twice)} appears more than once")


def _numbers(row: dict[str, str], columns: tuple[str, ...], line: int) -> list[float]:
    # ``csv`` collects surplus fields under the key None. They mean a decimal comma or a shifted
    # row.
    if None in row:
        raise PayloadFileInvalid(f"line {line}: more fields than columns")
    values = []
    for column in columns:
        text = row[column]
        try:
            value = float(text)
        except (TypeError, ValueError) as error:
            shown = "nothing" if text is None or not text.strip() else repr(text)
            raise PayloadFileInvalid(
                f"line {line}, column {column}: a number belongs here, found {shown}"
            ) from error
        if not np.isfinite(value):
            raise PayloadFileInvalid(f"line {line}, column {column}: {text} is not finite")
        values.append(value)
    return values


def _require_unit(quaternions: Array, lines: list[int]) -> None:
    norms = np.linalg.norm(quaternions, axis=1)
    for line, norm in zip(lines, norms, strict=True):
        if abs(norm - 1.0) > NORM_TOLERANCE:
            raise PayloadFileInvalid(
                f"line {line}: qx,qy,qz,qw has length {norm:.4f}, an orientation has length 1"
            )


def _role(row: dict[str, str], line: int) -> PoseRole:
    text = (row.get(ROLE) or PoseRole.FIT.value).strip().lower()
    try:
        return PoseRole(text)
    except ValueError as error:
        known = ", ".join(role.value for role in PoseRole)
        raise PayloadFileInvalid(
            f"line {line}, column {ROLE}: {text!r} is none of {known}"
        ) from error
