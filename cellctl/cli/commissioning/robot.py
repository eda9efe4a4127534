"""`cellctl robot`: what one robot says of itself. Moves nothing."""

import asyncio
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

from cellctl.cli.commissioning.one_robot import ANY_AGE_S, cell_with, connected, state_as_json
from cellctl.clock import now_s
from cellctl.config import CellConfig
from cellctl.interfaces import Robot, RobotState

_LOOK_S = 0.002


@dataclass(slots=True)
class Reports:
    """What has been heard of a robot for a while."""

    connect_s: float
    facts: dict[str, str]
    state: RobotState
    periods_s: list[float] = field(default_factory=list)
    """From one report to the next."""
    oldest_s: float = 0.0
    """Greatest age that the newest report has had."""


def robot(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")],
    name: Annotated[str, typer.Argument(help="The robot's name there.")],
    *,
    seconds: Annotated[float, typer.Option(min=0.5, max=600.0, help="How long to listen.")] = 3.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Connect to one robot without the daemon, listen, and print what it says. Moves nothing.

    Its links end with the command: the robot is then latched, until the daemon has re-armed it.
    """
    cell = cell_with(cell_file, name)
    heard = _as_json(asyncio.run(_listen(cell, name, seconds)))
    if as_json:
        typer.echo(json.dumps(heard, indent=2))
        return
    console = Console(soft_wrap=True, highlight=False)
    driver = cell.robots[name].driver
    console.print(f"{name} by {driver}: nothing was moved", markup=False)
    for part in ("link", "reports", "state"):
        console.print(part)
        for key, value in heard[part].items():
            console.print(f"  {key:24} {_text(value)}", markup=False)


async def _listen(cell: CellConfig, name: str, seconds: float) -> Reports:
    async with connected(cell, name) as (one, connect_s):
        reports = Reports(connect_s, one.link_facts(), one.state(ANY_AGE_S))
        await _collect(one, reports, now_s() + seconds)
        # Again, as a hello of a second channel may have come later.
        reports.facts = one.link_facts()
        return reports


async def _collect(one: Robot, reports: Reports, end_s: float) -> None:
    while now_s() < end_s:
        state, before = one.state(ANY_AGE_S), reports.state
        if state.time_s > before.time_s:
            reports.periods_s.append(state.time_s - before.time_s)
            reports.state = state
        reports.oldest_s = max(reports.oldest_s, now_s() - state.time_s)
        await asyncio.sleep(_LOOK_S)


def _as_json(reports: Reports) -> dict[str, Any]:
    heard: dict[str, Any] = {
        "link": {"connected_after_s": round(reports.connect_s, 3), **reports.facts},
        "reports": {"count": len(reports.periods_s)},
        "state": state_as_json(reports.state),
    }
    if reports.periods_s:
        p50, p99, most = np.percentile(reports.periods_s, [50, 99, 100]) * 1000
        heard["reports"] |= {
            "period_ms_p50": round(float(p50), 1),
            "period_ms_p99": round(float(p99), 1),
            "period_ms_max": round(float(most), 1),
        }
    heard["reports"]["oldest_ms"] = round(1000 * reports.oldest_s, 1)
    return heard


def _text(value: object) -> str:
    if isinstance(value, list):
        return "  ".join(f"{number:.3f}" for number in value)
    return str(value)
