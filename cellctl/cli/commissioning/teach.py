"""`cellctl teach`: taught poses of one robot, captured where a person has brought the arm."""

import asyncio
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

from cellctl.cell.robot_reports import joints_deg, state_as_json
from cellctl.cli.cell_daemon import require_no_daemon
from cellctl.cli.commissioning.one_robot import cell_with, connected
from cellctl.clock import now_s, utc_now
from cellctl.config import CellConfig, problems_before_commissioning
from cellctl.config.document.lines import key_lines
from cellctl.config.document.taught_pose_text import pose_line, with_pose
from cellctl.config.load import placed
from cellctl.errors.config import ConfigInvalid
from cellctl.files.atomic_files import write_durably
from cellctl.files.hand_written import read_hand_written
from cellctl.interfaces import Robot, RobotState
from cellctl.spelling import nearest
from cellctl.terminal.consoles import console_of_lines

_STILL_S = 0.5
_STILL_DEG = 0.01
"""Greatest change between two reports of an arm that stands; brakes and control move it less."""
_FRESH_S = 1.0


def teach(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")],
    name: Annotated[str, typer.Argument(metavar="ROBOT", help="The robot's name there.")],
    poses: Annotated[
        list[str] | None, typer.Argument(help="Poses to capture; none: only compare.")
    ] = None,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="Compare only, and print JSON.")] = False,
) -> None:
    """Capture taught poses; the arm is moved by hand or pendant and never by this command.

    Shows where the arm is and what the cell file has, and writes a pose only after a yes. Comments
    of the file stay. Run it without the daemon.
    """
    cell = cell_with(cell_file, name)
    require_no_daemon(cell, None)
    console = console_of_lines()
    if as_json or not poses:
        compared = asyncio.run(_compared(cell, name))
        if as_json:
            typer.echo(json.dumps(compared, indent=2))
        else:
            _show_comparison(console, name, compared)
        return
    meant = list(_meant(console, cell, name, poses))
    if meant:
        asyncio.run(_capture_all(console, cell_file, cell, name, meant))


def _meant(console: Console, cell: CellConfig, name: str, poses: Sequence[str]) -> Iterator[str]:
    """The poses without those whose names were mistyped, asked about before anybody brings an arm
    there: another name than the one that was meant would leave the old pose in use."""
    taught = cell.robots[name].poses_deg
    for pose in poses:
        if pose not in taught:
            likely = nearest(pose, taught) or f"it has {', '.join(taught) or 'none'}. "
            question = f"{name} has no pose {pose!r}: {likely}Is {pose!r} a new one?"
            if not typer.confirm(question):
                console.print(f"{pose}: left out")
                continue
        yield pose


async def _compared(cell: CellConfig, name: str) -> dict[str, Any]:
    async with connected(cell, name) as (robot, _):
        state = robot.state(_FRESH_S)
    taught = cell.robots[name].poses_deg
    return {
        "state": state_as_json(state),
        "poses": {
            pose: {"joints_deg": list(values), "off_deg": _off_deg(state, values)}
            for pose, values in taught.items()
        },
    }


async def _capture_all(
    console: Console, cell_file: Path, cell: CellConfig, name: str, poses: Sequence[str]
) -> None:
    async with connected(cell, name) as (robot, _):
        for pose in poses:
            await _capture(console, cell_file, cell, robot, pose)


async def _capture(
    console: Console, cell_file: Path, cell: CellConfig, robot: Robot, pose: str
) -> None:
    """Ask, look, show, ask again, write."""
    question = f"Bring {robot.name} to {pose!r} by hand or pendant, then press Enter"
    while True:
        # In a thread, as heartbeats must go on while a person walks to the arm.
        await asyncio.to_thread(typer.prompt, question, default="", show_default=False)
        state = await _standing(robot)
        if state is not None:
            break
        console.print("the arm moves; wait until it stands", style="yellow")
    _show(console, state, cell.robots[robot.name].poses_deg.get(pose))
    if not await asyncio.to_thread(typer.confirm, f"Write it as {robot.name}.{pose}?"):
        console.print(f"{pose}: left as it was")
        return
    write_pose(cell_file, robot.name, pose, joints_deg(state))
    console.print(f"{pose}: written to {cell_file}")


async def _standing(robot: Robot) -> RobotState | None:
    """The state of an arm that has not moved for a while; None for one that moves."""
    first = robot.state(_FRESH_S)
    end_s = now_s() + _STILL_S
    latest = first
    while now_s() < end_s or latest.time_s == first.time_s:
        latest = robot.state(_FRESH_S)
        if latest.moving or _off_deg(latest, joints_deg(first)) > _STILL_DEG:
            return None
        await asyncio.sleep(0.01)
    return latest


def write_pose(cell_file: Path, robot: str, pose: str, values_deg: Sequence[float]) -> None:
    """Write one pose, or nothing.

    Raises ``ConfigInvalid`` when `cellctl check` would find errors that the file does not have yet,
    ``FileInvalid`` when there is no place for the pose, ``OSError``.
    """
    remark = f"taught {utc_now():%Y-%m-%d %H:%M} UTC"
    before = read_hand_written(cell_file)
    after = with_pose(before, robot, pose, values_deg, remark)
    known = {(one.key, one.value) for one in problems_before_commissioning(cell_file, before)}
    found = problems_before_commissioning(cell_file, after)
    if new := [one for one in found if (one.key, one.value) not in known]:
        # Lines of the file that stays, which a new line would have moved.
        facts = "; ".join(str(one) for one in placed(new, key_lines(before)))
        raise ConfigInvalid(
            f"{pose} is not written, the file is as it was: {facts}. Where the other value is the "
            "wrong one, correct that first; the joints where the arm stands: "
            f"{pose_line(pose, values_deg)}"
        )
    write_durably(cell_file, after.encode("utf-8"))


def _show(console: Console, state: RobotState, taught: Sequence[float] | None) -> None:
    shown = state_as_json(state)
    console.print(f"  flange x y z A B C  {_text(shown['flange_xyzabc_mm_deg'])}")
    console.print(f"  joints now          {_text(shown['joints_deg'])}")
    if taught is None:
        console.print("  the cell file has no such pose yet")
        return
    console.print(f"  joints in the file  {_text(taught)}")
    console.print(f"  greatest difference {_off_deg(state, taught):.3f} deg")


def _show_comparison(console: Console, name: str, compared: dict[str, Any]) -> None:
    state = compared["state"]
    console.print(f"{name}: joints {_text(state['joints_deg'])} deg")
    for pose, one in compared["poses"].items():
        console.print(f"  {pose:24} {one['off_deg']:9.3f} deg away at most")


def _off_deg(state: RobotState, values_deg: Sequence[float]) -> float:
    difference = np.degrees(state.joints_rad) - np.asarray(values_deg, dtype=float)
    return round(float(np.abs(difference).max()), 5)


def _text(values: Sequence[float]) -> str:
    return "  ".join(f"{value:9.3f}" for value in values)
