"""Plugs by every scheme in drawn cells, against what is demanded.

Run with ``make campaign-antenna``, or alone with ``--quick`` (about a minute, fewer cells). Prints
two tables, writes ``runs/campaign-antenna-chain.json``; exit code 1 when a demand that is judged is
not met.
"""

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import astuple, replace
from itertools import repeat
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.antenna.chain.arms import (
    FACTORY,
    GEAR_MESH,
    IDEAL,
    RP_002,
    RP_005,
    TRACKER,
    UNCALIBRATED,
    Grade,
)
from benchmarks.antenna.chain.both_ways import BothWays, plugs_both_ways, together
from benchmarks.antenna.chain.demands import Demand, demands_met
from benchmarks.antenna.chain.drawn_cell import draw_cell
from benchmarks.antenna.chain.reference import ReferenceCounts, count_reference_checks
from benchmarks.antenna.chain.rows import Drawn, Row, draw_rows
from benchmarks.antenna.chain.trials import Conditions

WORKERS = 2
CELLS, PLUGS_PER_CELL = 23, 13
"""299 plugs: without a miss they prove 99 % at a confidence of 95 %."""
QUICK_CELLS = 3
IMAGE_CELLS = 3
"""A tenth and more of all plugs, with their teaching, are plugged with rendered images too."""
REFERENCE_ROUNDS = 11
"""Rounds in each cell, with each of four devices moved: 1012 checks in 23 cells."""
RESULT = Path("runs") / "campaign-antenna-chain.json"
HAND_EYE_WRONG = (0.3e-3, 0.05)
_ONLY = ("difference",)

Results = Mapping[str, Mapping[str, Drawn]]
"""Results by the name of the row, then by scheme."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few cells, and only what is demanded")
    parser.add_argument("--demanded", action="store_true", help="all cells, only what is demanded")
    parser.add_argument(
        "--only", nargs="+", choices=[*GROUPS, REFERENCE, IMAGES], help="parts of the campaign"
    )
    parser.add_argument("--seed", type=int, default=1301, help="seed of the first cell")
    arguments = parser.parse_args()
    cells = QUICK_CELLS if arguments.quick else CELLS
    seeds = range(arguments.seed, arguments.seed + cells)
    few = arguments.quick or arguments.demanded
    chosen = arguments.only or [*(DEMANDED if few else GROUPS), REFERENCE, IMAGES]
    groups = [rows for name in chosen if name in GROUPS for rows in GROUPS[name]()]
    console = Console(width=150)
    with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
        results = _draw(pool, groups, seeds, console)
        reference = _reference(pool, seeds) if REFERENCE in chosen else None
        images = _images(pool, seeds[:IMAGE_CELLS]) if IMAGES in chosen else None
    demands = demands_met(results, reference, images, whole=not arguments.quick)
    console.print(_table(results))
    console.print(_demand_table(demands))
    RESULT.parent.mkdir(exist_ok=True)
    RESULT.write_text(json.dumps(_record(results, demands), indent=1), encoding="utf-8")
    return 0 if all(demand.met for demand in demands if demand.judged) else 1


_COMPARED = ("difference", "absolute")
_WARM, _COLD = Conditions(kelvin=3.0), Conditions()
_SEVERAL = Conditions(kelvin=3.0, teachings=8, socket_looks=2)


def uncalibrated_rows() -> list[list[Row]]:
    """Each list of rows shares its cells."""
    rows = [Row(UNCALIBRATED, RP_002, _WARM), Row(UNCALIBRATED, RP_002, _SEVERAL, _COMPARED)]
    return [rows]


def factory_rows() -> list[list[Row]]:
    rows = [
        Row(FACTORY, RP_002, _WARM),
        Row(FACTORY, RP_002, _SEVERAL, _COMPARED),
        Row(FACTORY, RP_002, _COLD),
        Row(FACTORY, RP_002, _WARM, _ONLY, HAND_EYE_WRONG),
    ]
    return [rows]


def coarse_rows() -> list[list[Row]]:
    """A robot that repeats to 0.05 mm."""
    looks = Conditions(kelvin=3.0, socket_looks=4)
    return [[Row(FACTORY, RP_005, _WARM), Row(FACTORY, RP_005, looks, _ONLY)]]


def ripple_rows() -> list[list[Row]]:
    """Gears whose error changes over degrees, where plugs were taught and 100 mm beside it."""
    beside = replace(_SEVERAL, slot_m=0.1)
    return [[Row(GEAR_MESH, RP_002, _SEVERAL, _COMPARED), Row(GEAR_MESH, RP_002, beside, _ONLY)]]


def further_rows() -> list[list[Row]]:
    """Other arms, and slots that were not taught."""
    away = [Conditions(slot_m=distance) for distance in (0.0, 0.05, 0.1, 0.2)]
    grades: list[Grade] = [TRACKER, IDEAL]
    return [
        [Row(UNCALIBRATED, RP_002, Conditions()), *_slots(UNCALIBRATED, away)],
        _slots(FACTORY, away[1:]),
        *(
            [Row(grade, RP_002, Conditions(kelvin=kelvin)) for kelvin in (0.0, 3.0)]
            for grade in grades
        ),
    ]


GROUPS: Mapping[str, Callable[[], list[list[Row]]]] = {
    "uncalibrated": uncalibrated_rows,
    "factory": factory_rows,
    "rp-0.05": coarse_rows,
    "gear-mesh": ripple_rows,
    "further": further_rows,
}
DEMANDED = ("uncalibrated", "factory", "rp-0.05")
"""What the demands are judged by."""
REFERENCE, IMAGES = "reference", "images"


def _slots(grade: Grade, away: Sequence[Conditions]) -> list[Row]:
    return [Row(grade, RP_002, conditions, _ONLY) for conditions in away if conditions.slot_m]


def _draw(
    pool: Executor, groups: Sequence[Sequence[Row]], seeds: Sequence[int], console: Console
) -> Results:
    results: dict[str, Mapping[str, Drawn]] = {}
    for rows in groups:
        console.print(f"{len(seeds)} cells: {'; '.join(row.name for row in rows)}", markup=False)
        for row, drawn in zip(rows, draw_rows(pool, rows, seeds, PLUGS_PER_CELL), strict=True):
            results[row.name] = drawn
    return results


def _reference(pool: Executor, seeds: Sequence[int]) -> ReferenceCounts:
    each = list(pool.map(_reference_of, seeds))
    return ReferenceCounts(*(sum(column) for column in zip(*map(astuple, each), strict=True)))


def _images(pool: Executor, seeds: Sequence[int]) -> BothWays:
    return together(list(pool.map(plugs_both_ways, seeds, repeat(PLUGS_PER_CELL))))


def _reference_of(seed: int) -> ReferenceCounts:
    cell = draw_cell(np.random.default_rng([seed, 1]), FACTORY, RP_002)
    rng = np.random.default_rng([seed, 4])
    return count_reference_checks(cell, FACTORY.absolute_error_m, rng, REFERENCE_ROUNDS)


def _table(results: Results) -> Table:
    table = Table("row", "scheme", title="Plug against socket")
    for column in ("rms µm", "p95", "p99", "max", "predicted p99", "within 50 µm", "yaw rms °"):
        table.add_column(column, justify="right")
    for row, schemes in results.items():
        for scheme, drawn in schemes.items():
            record = drawn.to_record()
            figures = [f"{record[key]:.1f}" for key in ("rms_um", "p95_um", "p99_um", "max_um")]
            predicted = record["predicted_p99_um"]
            table.add_row(
                row,
                scheme,
                *figures,
                "" if np.isnan(predicted) else f"{predicted:.1f}",
                f"{record['within']:.0f} of {record['plugs']:.0f}",
                f"{record['yaw_rms_deg']:.3f}",
            )
    return table


def _demand_table(demands: Sequence[Demand]) -> Table:
    table = Table("no.", "what", "demanded", "measured", "", title="Demands")
    for demand in demands:
        mark = "met" if demand.met else "NOT MET" if demand.judged else "not met, reported only"
        table.add_row(demand.number, demand.what, demand.demanded, demand.measured, mark)
    return table


def _record(results: Results, demands: Sequence[Demand]) -> dict[str, object]:
    return {
        "rows": {
            row: {
                name: {
                    key: None if np.isnan(one) else one for key, one in drawn.to_record().items()
                }
                for name, drawn in schemes.items()
            }
            for row, schemes in results.items()
        },
        "demands": [
            {
                "number": one.number,
                "what": one.what,
                "measured": one.measured,
                "met": one.met,
                "judged": one.judged,
            }
            for one in demands
        ],
    }


if __name__ == "__main__":
    sys.exit(main())
