"""What was inserted, as a file: TOML by hand, or the record of an exported run."""

import json
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from cellctl.calibration.input_file import error_words
from cellctl.config.base import Section
from cellctl.config.checks.bounds.bound import bound_issues
from cellctl.config.issue import ConfigIssue
from cellctl.errors.config import FileInvalid
from cellctl.files.hand_written import read_hand_written
from cellctl.geometry.pose import MM
from cellctl.processes.peg_in_hole.plan.cycle_plan import fit_geometry, seat_limits
from cellctl.processes.peg_in_hole.plan.task import FitGeometry
from cellctl.processes.peg_in_hole.plausible.fit import drawing_bounds
from cellctl.processes.peg_in_hole.plausible.seat import seat_bounds, seat_order_issues
from cellctl.processes.peg_in_hole.recipe import Fit, Seat
from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.settings import STIFFNESS_N_MM
from cellctl.processes.peg_in_hole.verdict.judgement import PegSeatLimits

_Way = Annotated[float, Field(ge=-5, le=5)]


class JudgedCellSection(Section):
    """Of the cell that has inserted."""

    stiffness_n_mm: Annotated[float, Field(ge=STIFFNESS_N_MM[0], le=STIFFNESS_N_MM[1])]
    """Of arm and contact in series along the axis of the hole; procedure 301 measures it."""
    force_sigma_n: Annotated[float, Field(gt=0, le=10)]
    """Of the mean of ten samples of one component of the force, standard deviation."""


class FeltSection(Section):
    """What the curve itself does not hold."""

    face_yields_mm: _Way = 0.0
    """The touches of the face had pressed so deep beyond it: depth 0 lies so much below it."""
    greatest_n: Annotated[float, Field(ge=0, le=5000)] = 0.0
    """Greatest force along the axis since the part was gripped, before the curve begins."""


class CurveSection(Section):
    """How the file counts."""

    force_on: Literal["peg", "hole"] = "peg"
    """Whose force the columns have: that on the peg, or that of the peg on the hole."""


class JudgedPart(Section):
    """The whole file; drawing and seat are written as in a recipe."""

    fit: Fit
    seat: Seat
    cell: JudgedCellSection
    felt: FeltSection = Field(default_factory=FeltSection)
    curve: CurveSection = Field(default_factory=CurveSection)


@dataclass(frozen=True, slots=True)
class CellOfCurve:
    """See ``JudgedCell``."""

    stiffness_n_m: float
    force_sigma_n: float
    friction: float


@dataclass(frozen=True, slots=True)
class TaskOfCurve:
    """See ``JudgedTask``; with what else the verdict needs."""

    fit: FitGeometry
    cell: CellOfCurve
    seat: PegSeatLimits
    grip_n: float | None
    face_yields_m: float
    greatest_n: float

    @classmethod
    def of(cls, part: JudgedPart) -> "TaskOfCurve":
        """In SI units."""
        cell = CellOfCurve(
            part.cell.stiffness_n_mm / MM, part.cell.force_sigma_n, part.fit.friction
        )
        return cls(
            fit_geometry(part.fit),
            cell,
            seat_limits(part.fit, part.seat),
            part.seat.grip_n,
            part.felt.face_yields_mm * MM,
            part.felt.greatest_n,
        )


def read_part(path: Path) -> JudgedPart:
    """Raises ``FileInvalid`` with everything that is wrong."""
    try:
        text = read_hand_written(path)
    except (OSError, UnicodeDecodeError) as error:
        raise FileInvalid(f"{path}: {error}") from error
    try:
        return parse_part(text, as_json=path.suffix.lower() == ".json")
    except FileInvalid as fault:
        raise FileInvalid(f"{path}: {fault.detail}") from fault


def parse_part(text: str, *, as_json: bool = False) -> JudgedPart:
    """The same of the content of a file."""
    try:
        content: Any = json.loads(text) if as_json else tomllib.loads(text)
    # Deep brackets end the recursion of either parser.
    except (ValueError, RecursionError) as error:
        raise FileInvalid(f"is not {'JSON' if as_json else 'TOML'}: {error}") from error
    if as_json and isinstance(content, dict) and "documents" in content:
        found = _newest(content["documents"], keys.TASK)
        if found is None:
            text = f"the run has no document {keys.TASK}: no insertion by touch was begun"
            raise FileInvalid(text)
        content = found
    try:
        part = JudgedPart.model_validate(content)
    except ValidationError as error:
        raise FileInvalid(error_words(error)) from error
    if contradicted := [str(issue) for issue in _contradictions(part)]:
        raise FileInvalid("; ".join(contradicted))
    return part


def _contradictions(part: JudgedPart) -> Iterator[ConfigIssue]:
    """What `cellctl check` refuses in a recipe of the same figures."""
    yield from seat_order_issues(part.seat, "seat")
    yield from bound_issues(drawing_bounds(part.fit, "fit"))
    yield from bound_issues(seat_bounds(part.seat, part.cell.force_sigma_n, "seat"))


def recorded_evidence(path: Path) -> Mapping[str, Any] | None:
    """What the run of a task has found; None where the task is no run, or one without a verdict.

    Raises ``OSError`` and ``ValueError`` for a file that ``read_part`` refuses.
    """
    if path.suffix.lower() != ".json":
        return None
    content = json.loads(read_hand_written(path))
    result = _newest(content.get("documents"), keys.CYCLE)
    evidence = result.get("evidence") if isinstance(result, dict) else None
    return evidence if isinstance(evidence, dict) else None


def _newest(documents: object, key: str) -> object | None:
    """The newest content of that key that a run has recorded."""
    listed = documents if isinstance(documents, list) else []
    found = [
        one.get("content") for one in listed if isinstance(one, dict) and one.get("key") == key
    ]
    return found[-1] if found else None
