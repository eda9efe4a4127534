"""`cellctl run`: the daemon."""

import asyncio
import sys
from pathlib import Path
from typing import Annotated

import typer

from cellctl import log


def run(
    cell_file: Annotated[Path, typer.Argument(help="The cell's TOML file.")],
    data_dir: Annotated[
        Path | None, typer.Option(help="Run store; default: data_dir of the cell file.")
    ] = None,
    calibration_dir: Annotated[
        Path | None, typer.Option(help="Overrides calibration_dir of the cell file.")
    ] = None,
    modbus_port: Annotated[
        int | None, typer.Option(help="Overrides plc.port; 0 takes any free port.")
    ] = None,
    log_level: Annotated[
        log.LogLevel, typer.Option(case_sensitive=False, help="What is logged at least.")
    ] = log.LogLevel.INFO,
) -> None:
    """Run the cell until SIGTERM or Ctrl-C; motion is stopped before the process ends."""
    # Imported here, so that ``--help`` and the other commands need not load the daemon.
    from cellctl.daemon.heap import hold_collections

    hold_collections()
    from cellctl.daemon.app import Overrides, serve
    from cellctl.daemon.journal import journal_or

    log.configure(level=log_level, beside=True, stream=journal_or(sys.stderr))
    overrides = Overrides(data_dir, calibration_dir, modbus_port)
    sys.exit(asyncio.run(serve(cell_file, overrides)))
