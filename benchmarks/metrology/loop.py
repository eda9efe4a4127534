"""The measure-correct loop on many drawn cells: `python -m benchmarks.metrology.loop -n 20`.

World, renderer, calibrations and the functions of the process are those of `cellctl demo`; there is
no wire and no clock, so that it costs a fraction of the time and does not mind a busy machine. Each
seed: frame measured, deck measured on its flange, deck brought to its stand-off, then measured and
corrected until it is within the thresholds of the recipe.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import Annotated, Any

import cv2
import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from scipy.spatial.transform import RigidTransform

from benchmarks.campaign import COMPONENTS, decay
from benchmarks.metrology.fake_station import SCENARIO, FakeStation
from cellctl.calibration.store.store import CalibrationStore
from cellctl.clock import utc_now
from cellctl.config.load import load_cell
from cellctl.errors.base import CellError
from cellctl.geometry.pose import MM, Array, pose_error, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS
from cellctl.processes.deck_to_frame.poses.deck_on_flange import deck_on_flange
from cellctl.processes.deck_to_frame.poses.geometry import CalibrationSet
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry, deck_in_frame
from cellctl.processes.deck_to_frame.poses.pose_correction import (
    Thresholds,
    flange_target,
    judge_pose,
    next_target,
    target_M_T_D,
)
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import FeatureFile, read_features
from cellctl.vision.registration.part_pose import PartPose
from fakes.imperfections import parsed_scale
from fakes.scenes.deck_on_frame.scenario import DeckScenario

CONFIG = SCENARIO.parent


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """What all seeds share."""

    recipe: DeckRecipe
    base_T_c1: UncertainPose
    geometry: HeadGeometry
    frame: FeatureFile
    deck: FeatureFile

    @classmethod
    def shipped(cls) -> "Setting":
        """Recipe and calibrations of the demonstration."""
        (recipe,) = load_cell(CONFIG / "deck.toml").recipes
        assert isinstance(recipe, DeckRecipe)
        store = CalibrationStore(CONFIG / "demo-calibration", CALIBRATIONS)
        kinds = [kind.for_recipe(recipe.id) for kind in CALIBRATIONS]
        calibrations = CalibrationSet.of(store.read_all(kinds, utc_now() + timedelta(hours=1)))
        return cls(
            recipe,
            calibrations.base_T_c1,
            HeadGeometry.of(calibrations, recipe.pose_correction),
            read_features(CONFIG / recipe.frame_features),
            read_features(CONFIG / recipe.deck_features),
        )

    @property
    def thresholds(self) -> Thresholds:
        """Those of the recipe."""
        settings = self.recipe.pose_correction
        about_x, about_y, about_z = np.radians(settings.thresholds_deg).tolist()
        return Thresholds(settings.threshold_mm * MM, (about_x, about_y, about_z))


@dataclass(frozen=True, slots=True, eq=False)
class LoopEnd:
    """A deck at its stand-off after the loop, and what is known of it."""

    station: FakeStation
    frame: PartPose
    """As the heads measured it before the loop."""
    M_T_D: UncertainPose
    flange_T_deck: RigidTransform
    converged: bool
    looks: tuple[dict[str, list[float]], ...]


def run_loop(setting: Setting, scenario: DeckScenario, seed: int) -> dict[str, Any]:
    """Errors that each look found, what was true, and how sure it was; mm and degrees."""
    end = follow_loop(setting, scenario, seed)
    return {
        "seed": seed,
        "converged": end.converged,
        "errors_mm_deg": [look["error_mm_deg"] for look in end.looks],
        "looks": end.looks,
    }


def follow_loop(setting: Setting, scenario: DeckScenario, seed: int) -> LoopEnd:
    """Draw a cell and bring its deck to the stand-off; raises the faults of the vision."""
    recipe, settings = setting.recipe, setting.recipe.pose_correction
    station = FakeStation(scenario, seed, setting.geometry)
    base_T_c1 = setting.base_T_c1
    target = target_M_T_D(recipe.deck_thickness_mm * MM, recipe.stand_off_mm * MM)

    nominal = base_T_c1.pose.inv() * pose_from_xyzabc(recipe.base_T_frame)
    frame, _ = station.measure(setting.frame, nominal, settings, setting.thresholds)
    station.to_deck_measure()
    held = station.base_T_flange()
    nominal = base_T_c1.pose.inv() * held * pose_from_xyzabc(recipe.flange_T_deck)
    deck, _ = station.measure(setting.deck, nominal, settings, setting.thresholds)
    flange_T_deck = deck_on_flange(UncertainPose.exact(held), base_T_c1, deck.pose).pose

    looks: list[dict[str, list[float]]] = []
    commanded = target
    while len(looks) <= settings.max_iterations:
        base_T_flange = flange_target(base_T_c1.pose, frame.pose.pose, commanded, flange_T_deck)
        station.move_flange(base_T_flange)
        predicted = base_T_c1.pose.inv() * base_T_flange * flange_T_deck
        deck, frames = station.measure(setting.deck, predicted, settings, setting.thresholds)
        M_T_D = deck_in_frame(frame, deck, setting.geometry, settings.method).part_1_T_part_2
        judgement = judge_pose(target, M_T_D, setting.thresholds)
        looks.append(_look(judgement.error, M_T_D, station.true_frame_T_deck(), frames))
        if judgement.converged:
            break
        commanded = next_target(commanded, target, M_T_D.pose)
    return LoopEnd(station, frame, M_T_D, flange_T_deck, judgement.converged, tuple(looks))


def _look(
    error: Array, M_T_D: UncertainPose, truth: RigidTransform, frames: int
) -> dict[str, list[float]]:
    off = np.concatenate(pose_error(M_T_D.pose, truth))
    squared = float(off @ np.linalg.solve(M_T_D.covariance, off))
    return {
        "error_mm_deg": in_mm_deg(error).tolist(),
        "off_truth_mm_deg": in_mm_deg(off).tolist(),
        "sigma_mm_deg": in_mm_deg(M_T_D.sigma).tolist(),
        "normalised_squared": [squared],
        "frames": [float(frames)],
    }


def normalised(results: Sequence[Mapping[str, Any]]) -> Table:
    """What the last look of each run was off the truth, against what it said of itself."""
    last = [result["looks"][-1] for result in results]
    off = np.array([look["off_truth_mm_deg"] for look in last])
    sigma = np.array([look["sigma_mm_deg"] for look in last])
    squared = np.array([look["normalised_squared"][0] for look in last]) / 6.0
    table = Table(
        "rms of", *COMPONENTS, title=f"{len(last)} runs: squared over 6, mean {squared.mean():.2f}"
    )
    for name, values in (("off the truth", off), ("stated sigma", sigma), ("ratio", off / sigma)):
        rms = np.sqrt(np.mean(values**2, axis=0))
        table.add_row(name, *(f"{value:.4f}" for value in rms))
    return table


def main(
    n: Annotated[int, typer.Option("-n", min=1, help="Number of seeds.")] = 20,
    first: Annotated[int, typer.Option(help="First seed.")] = 1,
    out: Annotated[Path, typer.Option(help="Where the figures go.")] = Path("runs/loop.json"),
    imperfection: Annotated[
        list[str] | None, typer.Option(help="NAME=SCALE in place of that of the scenario file.")
    ] = None,
) -> None:
    """Run the seeds, print the tables; exit code 1 when a loop did not converge."""
    cv2.setNumThreads(1)
    console = Console(highlight=False, width=150)
    scenario = DeckScenario.read(SCENARIO, dict(map(parsed_scale, imperfection or ())))
    setting = Setting.shipped()
    results: list[dict[str, Any]] = []
    failed = 0
    out.parent.mkdir(parents=True, exist_ok=True)
    for seed in range(first, first + n):
        try:
            results.append(run_loop(setting, scenario, seed))
        except CellError as fault:
            failed += 1
            console.print(f"seed {seed}: {fault}", style="red")
            continue
        failed += not results[-1]["converged"]
        frames = ", ".join(f"{look['frames'][0]:.0f}" for look in results[-1]["looks"])
        console.print(f"seed {seed}: converged {results[-1]['converged']}; frames {frames}")
        out.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    if results:
        console.print(decay(results))
        console.print(normalised(results))
    raise typer.Exit(1 if failed else 0)


if __name__ == "__main__":
    typer.run(main)
