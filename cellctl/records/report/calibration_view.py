"""The calibrations that a run used, as tables (paper, tables 1 and 2)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import MAXYEAR
from typing import Any

import numpy as np

from cellctl.records.entries import Calibration
from cellctl.records.report.text import MISSING, fixed, number, standard_uncertainty, when

_DECIMALS = (3, 3, 3, 4, 4, 4)


@dataclass(frozen=True, slots=True)
class CalibrationLine:
    """One record in the list of what was used."""

    kind: str
    serial_number: str
    id: str
    made: str
    valid_until: str
    software: str
    verdict: str
    checks: str


@dataclass(frozen=True, slots=True)
class PoseLine:
    """One transform: X, Y, Z in mm, A, B, C in degrees, and its standard deviations."""

    parent: str
    child: str
    values: tuple[str, ...]
    sigmas: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class HeadLine:
    """One stereo head."""

    name: str
    focal_px: str
    centre_px: str
    baseline_mm: str
    toe_in_deg: str
    rms_px: str


def calibration_lines(
    used: Mapping[str, str], stored: Mapping[str, Calibration]
) -> list[CalibrationLine]:
    """Every calibration the run names, also one that the store does not hold."""
    lines = []
    for kind, identity in used.items():
        found = stored.get(identity)
        lines.append(
            CalibrationLine(
                kind=kind.replace("_", " "),
                serial_number=(found.serial_number if found else "") or MISSING,
                id=identity,
                made=when(found.made) if found else MISSING,
                valid_until=_valid_until(found) if found else MISSING,
                software=found.software if found else MISSING,
                verdict=_verdict(found) if found else "not in this store",
                checks=_checks(found.record) if found else MISSING,
            )
        )
    return lines


def _valid_until(found: Calibration) -> str:
    if found.invalidated is not None:
        return f"invalidated {when(found.invalidated)}: {found.invalidated_reason}"
    # The calibrations that are shipped for the fake cell never expire.
    return "no expiry" if found.valid_until.year == MAXYEAR else when(found.valid_until)


def _verdict(found: Calibration) -> str:
    """The verdict in the record's own words; for a payload identification, which has none, whether
    it was accepted."""
    verdict = found.record.get("verdict")
    if verdict is not None:
        return str(verdict)
    accepted = found.record.get("accepted")
    return MISSING if accepted is None else ("pass" if accepted else "fail")


def pose_lines(records: Sequence[Calibration]) -> list[PoseLine]:
    """Every transform found in the records, each once."""
    found: dict[tuple[str, str], PoseLine] = {}
    for stored in records:
        for name, pose in _poses(stored.record):
            parent, _, child = name.partition("_T_")
            found.setdefault((parent, child), _pose_line(parent, child, pose))
    return list(found.values())


def head_lines(records: Sequence[Calibration]) -> list[HeadLine]:
    """Every stereo head found in the records."""
    return [
        _head_line(stored.kind, stored.record)
        for stored in records
        if {"left", "right", "rotation", "translation_mm"} <= set(stored.record)
    ]


def _poses(document: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for key, value in document.items():
        if not isinstance(value, Mapping):
            continue
        if "_T_" in key and "xyz_abc_mm_deg" in value:
            yield key, value
        else:
            yield from _poses(value)


def _pose_line(parent: str, child: str, pose: Mapping[str, Any]) -> PoseLine:
    covariance = np.array(pose.get("covariance_mm_deg", np.full((6, 6), np.nan)), dtype=float)
    sigmas = np.sqrt(np.diag(covariance))
    values = zip(pose["xyz_abc_mm_deg"], _DECIMALS, strict=True)
    return PoseLine(
        parent=parent.replace("_", " ").upper(),
        child=child.replace("_", " ").upper(),
        values=tuple(fixed(value, decimals) for value, decimals in values),
        sigmas=tuple(
            standard_uncertainty(s, d + 1) for s, d in zip(sigmas.tolist(), _DECIMALS, strict=True)
        ),
    )


def _head_line(kind: str, record: Mapping[str, Any]) -> HeadLine:
    cameras = [np.array(record[side]["camera_matrix"]) for side in ("left", "right")]
    rotation = np.array(record["rotation"])
    # Rounding can bring the cosine a little above one, where arccos is not a number.
    toe_in_deg = np.degrees(np.arccos(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
    return HeadLine(
        name=kind.replace("_", " "),
        focal_px=" / ".join(f"{camera[0, 0]:.2f}, {camera[1, 1]:.2f}" for camera in cameras),
        centre_px=" / ".join(f"{camera[0, 2]:.2f}, {camera[1, 2]:.2f}" for camera in cameras),
        baseline_mm=f"{np.linalg.norm(record['translation_mm']):.4f}",
        toe_in_deg=f"{toe_in_deg:.4f}",
        rms_px=number(float(record.get("rms_px", np.nan))),
    )


def _checks(record: Mapping[str, Any]) -> str:
    checks = record.get("checks", [])
    passed = sum(bool(check.get("passed")) for check in checks)
    return f"{passed} of {len(checks)}" if checks else MISSING
