"""The fake cell and its helpers: ``python -m fakes run | operator | plc | demo | taught``, and
``imperfections``."""

import asyncio
import json
import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from fakes.imperfections import CATALOGUE, UnknownImperfection, parsed_scale
from fakes.scenario_file.sections import JobController
from fakes.scenes.load import load
from fakes.taught import taught as taught_poses

DEFAULT_SCENARIO = Path("config/deck.scenario.toml")
DEFAULT_CONTROL = 7900
"""That of the shipped scenarios."""
ScenarioOption = Annotated[Path, typer.Option("--scenario", help="Scenario file.")]
RobotsOption = Annotated[
    JobController | None,
    typer.Option(
        "--robots", help="What all controllers do, in place of what the scenario file says."
    ),
]

app = typer.Typer(
    help="The fake cell, a line PLC, and the demonstration of both.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


@app.command()
def taught(scenario: ScenarioOption = DEFAULT_SCENARIO) -> None:
    """Print taught poses of the nominal cell as JSON."""
    json.dump(taught_poses(load(scenario)), sys.stdout, indent=2)
    sys.stdout.write("\n")


@app.command()
def imperfections() -> None:
    """List what can be imperfect about a fake cell: size, where it acts, its source, its seed."""
    for name, one in CATALOGUE.items():
        size = f"{one.size:g} {one.unit}" if one.unit else ", ".join(one.keys)
        seed = "none" if one.drawn_by is None else f"of the {one.drawn_by}"
        typer.echo(f"{name}: {size}\n    {one.acts}\n    source: {one.source}\n    seed: {seed}")


@app.command()
def run(
    *,
    scenario: ScenarioOption = DEFAULT_SCENARIO,
    seed: Annotated[int, typer.Option(min=0, help="Reproduces the whole cell.")] = 1,
    port: Annotated[
        list[str] | None, typer.Option(help="NAME=PORT, as in main.CMD=7001 or control=0.")
    ] = None,
    imperfection: Annotated[
        list[str] | None, typer.Option(help="NAME=SCALE, in place of that of the scenario file.")
    ] = None,
    robots: RobotsOption = None,
    gentl: Annotated[
        Path | None,
        typer.Option(
            help="Cameras behind the fake GenTL producer, shown by this file, in place of frame "
            "servers."
        ),
    ] = None,
) -> None:
    """Run the fake cell until SIGINT or SIGTERM."""
    from fakes.cell import run_cell

    ports = dict(_port(item) for item in port or [])
    scales = dict(_scale(item) for item in imperfection or [])
    written = load(scenario, scales)
    described = written if robots is None else written.with_controllers(robots)
    raise typer.Exit(asyncio.run(run_cell(described, seed, ports, gentl)))


@app.command()
def operator(
    command: Annotated[str, typer.Argument(help="As fakes/README.md lists them, or status.")],
    members: Annotated[
        list[str] | None, typer.Argument(help="NAME=VALUE, as in head=head_1 or frame=false.")
    ] = None,
    port: Annotated[int, typer.Option(help="Control port of the fake cell.")] = DEFAULT_CONTROL,
) -> None:
    """Be the hands of the operator at a fake cell that runs: lay boards, bring parts.

    Prints what the fake cell answers, as JSON; exit code 1 when it refuses or is not there.
    """
    from fakes.demo.control import Control, Refused

    given = dict(_member(item) for item in members or [])
    try:
        control = Control(port)
    except OSError as error:
        typer.echo(f"no fake cell listens on port {port}: {error}", err=True)
        raise typer.Exit(1) from error
    try:
        reply = control.request(command, **given)
    except Refused as error:
        typer.echo(str(error), err=True)
        raise typer.Exit(1) from error
    finally:
        control.close()
    typer.echo(json.dumps({key: value for key, value in reply.items() if key != "id"}))


def _member(item: str) -> tuple[str, Any]:
    """Name and value; a value that is no JSON is a text."""
    name, separator, value = item.partition("=")
    if not (separator and name):
        raise typer.BadParameter(f"expected NAME=VALUE, got {item!r}")
    try:
        return name, json.loads(value)
    except ValueError:
        return name, value


def _port(item: str) -> tuple[str, int]:
    name, separator, number = item.partition("=")
    if not (separator and number.isdigit()):
        raise typer.BadParameter(f"expected NAME=PORT, got {item!r}")
    return name, int(number)


def _scale(item: str) -> tuple[str, float]:
    try:
        return parsed_scale(item)
    except UnknownImperfection as error:
        raise typer.BadParameter(str(error)) from error


_FORWARDED = {"ignore_unknown_options": True, "allow_extra_args": True, "help_option_names": []}


@app.command(context_settings=_FORWARDED)
def plc(context: typer.Context) -> None:
    """Act as the line PLC; see ``plc --help``."""
    from fakes.wire.line import plc as line_plc

    line_plc.app(args=context.args, prog_name="python -m fakes plc")


@app.command(context_settings=_FORWARDED)
def demo(context: typer.Context) -> None:
    """Run a whole demonstration; see ``demo --help``."""
    from fakes.demo import app as orchestrator

    # Whoever starts it as its own command says how that is called.
    name = os.environ.get("FAKES_DEMO_NAME", "python -m fakes demo")
    orchestrator.app(args=context.args, prog_name=name)


if __name__ == "__main__":
    app()
