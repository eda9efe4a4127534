"""Predicted against measured: the deck in its frame, in many drawn fake cells.

`python -m benchmarks.planning.predicted -n 200` measures each cell with the heads at their taught
poses, without wire and clock, and holds the scatter about the truth against what planning predicts
from drawings, calibrations and the model of the cell. Goes on where an earlier run ended.
"""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from benchmarks.campaign import COMPONENTS
from benchmarks.metrology.fake_station import FRAME_S, SCENARIO
from benchmarks.metrology.loop import Setting
from benchmarks.planning.measured_decks import MeasuredDeck, measured_deck
from cellctl.config import load_cell
from cellctl.config.model_file import model_path
from cellctl.config.stated.views import StatedMeasurement, StatedPart
from cellctl.errors.base import CellError
from cellctl.geometry.pose import MM, Array
from cellctl.geometry.units import in_mm_deg
from cellctl.planning.model.read import read_model
from cellctl.planning.views.plan_viewpoints import stated_measurements, taught_placement
from cellctl.planning.views.prediction import PredictedPose, predicted_pose
from fakes.scenes.deck_on_frame.scenario import DeckScenario

CELL_FILE = SCENARIO.parent / "deck.toml"
FRAMES = 2
HONEST = (0.8, 1.25)
_SWAY_HZ = 12.0
"""Frequency at which the fake cell sways (``fakes.world.flaws.camera``): a pure sine."""


def prediction(scenario: DeckScenario) -> PredictedPose:
    """At the taught poses, with the spread of the holes and the sway that the fake cell has.

    The drawing allows holes to be off by more than they are, which is not what is tested here.
    """
    scene = read_model(load_cell(CELL_FILE), model_path(CELL_FILE), CELL_FILE.parent)
    (stated,) = stated_measurements(scene)
    parts = tuple(_as_made(part, scenario.parts.hole_sigma_mm * MM) for part in stated.parts)
    statement = replace(stated, parts=parts, frames=FRAMES, sway_m=_sway_m(stated))
    return predicted_pose(taught_placement(scene, statement), explain=True)


def _as_made(part: StatedPart, sigma_m: float) -> StatedPart:
    seen = {
        head: tuple(replace(hole, position_sigma_m=sigma_m) for hole in holes)
        for head, holes in part.seen.items()
    }
    return replace(part, seen=seen)


def _sway_m(stated: StatedMeasurement) -> float:
    """What the recipe states is for pictures that do not know of each other. Two pictures of a
    sine at a fixed distance in time do: their mean has the variance (1 + cos φ) / 2 of one."""
    phase_rad = 2.0 * np.pi * _SWAY_HZ * FRAME_S
    return float(stated.sway_m * np.sqrt(1.0 + np.cos(phase_rad)))


def _as_json(seed: int, deck: MeasuredDeck) -> dict[str, Any]:
    return {
        "seed": seed,
        "off": deck.off_truth.tolist(),
        "cov": deck.found.part_1_T_part_2.covariance.tolist(),
    }


def compare(measured: Sequence[dict[str, Any]], predicted: PredictedPose) -> tuple[Table, bool]:
    """Mean and scatter of what was measured beside the prediction; whether each ratio is honest."""
    off = np.array([one["off"] for one in measured])
    stated = np.sqrt([np.diag(one["cov"]) for one in measured])
    scatter = off.std(axis=0, ddof=1)
    ratio = scatter / predicted.sigma
    table = Table("", *COMPONENTS, title=f"deck in frame, {len(off)} cells, {FRAMES} pictures")
    rows: list[tuple[str, Array]] = [
        ("scatter", in_mm_deg(scatter)),
        ("predicted", in_mm_deg(predicted.sigma)),
        ("ratio", ratio),
        ("stated by the measurement", in_mm_deg(np.sqrt(np.mean(stated**2, axis=0)))),
        ("mean off the truth", in_mm_deg(off.mean(axis=0))),
        ("predicted of the calibration", in_mm_deg(np.sqrt(np.diag(predicted.calibration)))),
    ]
    for name, values in rows:
        table.add_row(name, *(f"{value:.4f}" for value in values))
    return table, bool(((ratio >= HONEST[0]) & (ratio <= HONEST[1])).all())


def main(
    n: Annotated[int, typer.Option("-n", min=2, help="Number of drawn cells.")] = 200,
    first: Annotated[int, typer.Option(help="First seed.")] = 1001,
    out: Annotated[Path, typer.Option(help="One line of figures for each cell.")] = Path(
        "runs/predicted.jsonl"
    ),
) -> None:
    """Measure, print the table; exit code 1 when a ratio is not from 0.8 to 1.25."""
    cv2.setNumThreads(1)
    console = Console(highlight=False, width=150)
    scenario, setting = DeckScenario.read(SCENARIO, {}), Setting.shipped()
    out.parent.mkdir(parents=True, exist_ok=True)
    text = out.read_text(encoding="utf-8") if out.exists() else ""
    measured = [json.loads(line) for line in text.splitlines()]
    done = {one["seed"] for one in measured}
    for seed in range(first, first + n):
        if seed in done:
            continue
        try:
            deck = measured_deck(setting, scenario, seed, setting.geometry, FRAMES)
        except CellError as fault:
            console.print(f"seed {seed}: {fault}", style="red")
            continue
        measured.append(_as_json(seed, deck))
        with out.open("a", encoding="utf-8") as file:
            print(json.dumps(measured[-1]), file=file)
    table, honest = compare(measured, prediction(scenario))
    console.print(table)
    raise typer.Exit(0 if honest else 1)


if __name__ == "__main__":
    typer.run(main)
