"""The fake cell and its helpers: ``python -m fakes run | plc | demo | taught | imperfections``."""

import asyncio
import json
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from fakes.imperfections import CATALOGUE, UnknownImperfection, parsed_scale
from fakes.scenario_file.sections import JobController
from fakes.scenes.load import load
from fakes.taught import taught as taught_poses

DEFAULT_SCENARIO = Path("config/deck.scenario.toml")
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
    """List what can be imperfect about a fake cell: size, where it acts, source of the size."""
    for name, one in CATALOGUE.items():
        size = f"{one.size:g} {one.unit}" if one.unit else ", ".join(one.keys)
        typer.echo(f"{name}: {size}\n    {one.acts}\n    source: {one.source}")


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
