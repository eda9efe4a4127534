"""Ways of random cells: planned or refused with a number, and verified by MuJoCo's distances.

Each planned way is looked at again by an independent library, at the latest every 1 mm that any
body may have moved beyond the room that it had. Goes on where an earlier run ended.
Usage: python -m benchmarks.planning.campaign -n 100
With --views the heads are planned too, in place of taught for the displaced frame.
"""

import json
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise, product
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from benchmarks.planning.cells import random_cell
from benchmarks.planning.views_in_cells import with_planned_views
from cellctl.errors.config import PlanningError
from cellctl.geometry.pose import MM
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.ways.plan_ways import PlannedWay, plan_ways
from tests.rigs.mujoco_oracle import MujocoOracle

_LOOK_M = 0.001


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came out for one random cell."""

    seed: int
    reason: str
    """``planned``, or the number and words of the refusal."""
    seconds: float
    points: int
    least_slack_mm: float
    """Smallest slack that MuJoCo found on all ways; infinite for a cell that was refused."""
    worst_share: float = np.nan
    """Of its threshold, for the least certain component, where viewpoints were planned."""


def try_cell(
    seed: int, look_m: float = _LOOK_M, search_s: float = 20.0, *, views: bool = False
) -> Outcome:
    """Plan all ways of one random cell, and with ``views`` its viewpoints first; verify them."""
    begin_s = time.monotonic()
    ways: list[PlannedWay] = []
    slacks: list[float] = []
    reason, seconds, worst_share = "planned", 0.0, np.nan
    try:
        if views:
            viewed = with_planned_views(random_cell(seed))
            scene, worst_share = viewed.scene, viewed.worst_share
            slacks.append(viewed.least_slack_mm * MM)
        else:
            scene = random_cell(seed).scene()
        ways.extend(plan_ways(scene, seed=seed, search_s=search_s))
        seconds = time.monotonic() - begin_s
        slacks += [_least_slack_m(scene, way, look_m) for way in ways]
    except PlanningError as fault:
        reason = f"F{fault.number} {fault.text}"
        print(f"cell {seed}: {fault}", flush=True)
        seconds = time.monotonic() - begin_s
    points = sum(len(way.joints_rad) - 2 for way in ways)
    return Outcome(seed, reason, seconds, points, min(slacks, default=np.inf) / MM, worst_share)


def _least_slack_m(scene: CellScene, way: PlannedWay, look_m: float) -> float:
    """Smallest slack, the other arms at all combinations of the poses that the way allows for."""
    oracle = MujocoOracle(scene)
    if way.robot == "main":
        heads = [[(name, pose) for pose in ("measuring", "retracted")] for name in _heads(scene)]
        standing = [dict(choice) for choice in product(*heads)]
    else:
        others = [name for name in _heads(scene) if name != way.robot]
        standing = [
            {"main": "home", **dict.fromkeys(others, pose)} for pose in ("measuring", "retracted")
        ]
    lever_m = scene.around(way.robot, {}).lever_m
    least_m = np.inf
    for start_rad, end_rad in pairwise(way.joints_rad):
        length_m = float(np.abs(end_rad - start_rad) @ lever_m)
        gone_m = 0.0
        while True:
            share = gone_m / length_m if length_m else 1.0
            at_rad = start_rad + share * (end_rad - start_rad)
            here_m = min(
                oracle.narrowest_slack_m(
                    way.robot,
                    {name: scene.arms[name].taught_rad(pose) for name, pose in poses.items()}
                    | {way.robot: at_rad},
                )
                for poses in standing
            )
            least_m = min(least_m, here_m)
            if gone_m >= length_m:
                break
            # Where there is room, no body can have used it up before it has moved so far.
            gone_m = min(length_m, gone_m + max(look_m, here_m))
    return float(least_m)


def _heads(scene: CellScene) -> list[str]:
    return [name for name in scene.arms if name != "main"]


def main(
    n: Annotated[int, typer.Option("-n", min=1, help="Number of drawn cells.")] = 100,
    first: Annotated[int, typer.Option(help="First seed.")] = 1,
    look_mm: Annotated[float, typer.Option(min=0.1, help="Between two looks.")] = _LOOK_M / MM,
    out: Annotated[Path | None, typer.Option(help="One line for each cell.")] = None,
    *,
    views: Annotated[bool, typer.Option("--views", help="Plan the viewpoints too.")] = False,
) -> None:
    """Print a table of the outcomes; exit code 1 where a planned way has less than its margins."""
    out = out or Path("runs/views-and-ways.jsonl" if views else "runs/ways.jsonl")
    out.parent.mkdir(parents=True, exist_ok=True)
    text = out.read_text(encoding="utf-8") if out.exists() else ""
    done = {found.seed: found for found in map(_read, text.splitlines())}
    for seed in range(first, first + n):
        if seed not in done:
            done[seed] = try_cell(seed, look_mm * MM, views=views)
            with out.open("a", encoding="utf-8") as file:
                print(json.dumps(asdict(done[seed])), file=file)
    outcomes = [done[seed] for seed in range(first, first + n)]
    _print(outcomes, look_mm)
    raise typer.Exit(int(any(one.least_slack_mm < 0.0 for one in outcomes)))


def _read(line: str) -> Outcome:
    return Outcome(**json.loads(line))


def _print(outcomes: Sequence[Outcome], look_mm: float) -> None:
    for reason, count in sorted(Counter(one.reason for one in outcomes).items()):
        print(f"{count:4} {reason}")
    seconds = [one.seconds for one in outcomes]
    print(f"time of a plan: median {np.median(seconds):.1f} s, longest {max(seconds):.1f} s")
    planned = [one for one in outcomes if one.reason == "planned"]
    shares = [one.worst_share for one in planned if np.isfinite(one.worst_share)]
    if shares:
        print(
            f"least certain component, of its threshold: median {np.median(shares):.2f}, "
            f"greatest {max(shares):.2f}"
        )
    if planned:
        worst = min(planned, key=lambda one: one.least_slack_mm)
        print(
            f"least room beyond the margins, by MuJoCo every {look_mm:g} mm: "
            f"{worst.least_slack_mm:.2f} mm (cell {worst.seed})"
        )


if __name__ == "__main__":
    typer.run(main)
