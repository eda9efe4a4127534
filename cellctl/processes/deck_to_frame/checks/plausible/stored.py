"""Holds a recipe against the calibrations that are stored already, where there are any."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cellctl.calibration.store.readable_record import readable_record
from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import (
    BOARD_TRANSFER_NAME,
    CONTACT_STIFFNESS_NAME,
    HEAD_JOINTS,
    STOP_LATENCY_NAME,
)
from cellctl.processes.deck_to_frame.roles import HEAD_1, HEAD_2, MAIN, MEASURING, RETRACTED

SAME_DEG = 0.1
"""Two poses that differ by less in every axis are one pose that was written twice."""


def stored_record(cell: CellConfig, folder: Path, kind: str) -> Mapping[str, Any] | None:
    """The record of a calibration that nothing has invalidated; None where none can be read."""
    return readable_record(folder / cell.calibration_dir, kind)


def stored_issues(
    cell: CellConfig, recipe: DeckRecipe, key: str, folder: Path
) -> Iterator[ConfigIssue]:
    """Poses exchanged since the heads were calibrated, bounds below what was measured."""
    yield from _exchanged(cell, recipe, folder)
    yield from _bounds(cell, recipe, key, folder)


def calibrated_joints_deg(cell: CellConfig, folder: Path, role: str) -> list[float] | None:
    """Joints of the arm of a role's head for which the board transfer holds."""
    transfer = stored_record(cell, folder, BOARD_TRANSFER_NAME)
    joints = (transfer or {}).get(HEAD_JOINTS, {}).get(role)
    return joints if isinstance(joints, list) and len(joints) == 6 else None


def same_joints(one: object, other: object) -> bool:
    """Whether two sets of six joints in degrees are one pose."""
    return bool(np.max(np.abs(np.subtract(one, other))) < SAME_DEG)  # type: ignore[call-overload]


def _exchanged(cell: CellConfig, recipe: DeckRecipe, folder: Path) -> Iterator[ConfigIssue]:
    for role in (HEAD_1, HEAD_2):
        carrier = cell.stereo_cameras[recipe.device(role)].carried_by or ""
        joints = calibrated_joints_deg(cell, folder, role)
        poses = cell.robots[carrier].poses_deg
        if joints is not None and same_joints(joints, poses[RETRACTED]):
            allowed = (
                f"the joints of its pose {RETRACTED}: with these the stored {BOARD_TRANSFER_NAME} "
                "was measured; did you exchange them?"
            )
            where = f"robots.{carrier}.poses_deg.{MEASURING}"
            yield ConfigIssue(where, str(list(poses[MEASURING])), allowed)


def _bounds(cell: CellConfig, recipe: DeckRecipe, key: str, folder: Path) -> Iterator[ConfigIssue]:
    measured = {
        "stop_latency_ms": (STOP_LATENCY_NAME, "latency_ms"),
        "stiffness_n_per_mm": (f"{CONTACT_STIFFNESS_NAME}_{recipe.id}", "stiffness_n_per_mm"),
    }
    for name, (kind, figure) in measured.items():
        record, bound = stored_record(cell, folder, kind), float(getattr(recipe.mating, name))
        least = None if record is None else record.get(figure)
        if isinstance(least, int | float) and bound < least:
            allowed = f"an upper bound, more than {least:.4g}, which the stored {kind} measured"
            yield ConfigIssue(f"{key}.mating.{name}", f"{bound:g}", allowed)
    yield from _stop_timeout(cell, recipe, folder)


def _stop_timeout(cell: CellConfig, recipe: DeckRecipe, folder: Path) -> Iterator[ConfigIssue]:
    """A stop that would count as refused before the arm can have obeyed it."""
    main = recipe.device(MAIN)
    written_s = cell.robots[main].settings.get("stop_timeout_s")
    latency_ms = (stored_record(cell, folder, STOP_LATENCY_NAME) or {}).get("latency_ms")
    if written_s is None or not isinstance(latency_ms, int | float):
        return
    if written_s < latency_ms / 1000.0:
        allowed = (
            f"more than {latency_ms / 1000.0:.3g}, which the stored {STOP_LATENCY_NAME} measured"
        )
        yield ConfigIssue(f"robots.{main}.settings.stop_timeout_s", f"{written_s:g}", allowed)
