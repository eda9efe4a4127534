"""`cellctl calibrate invalidate`: say that a calibration is worthless, whatever its date."""

import os
from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from cellctl.calibration.store.envelope import StoredCalibration
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cli.nearest_cell import SERVICE_CELL
from cellctl.cli.os_user import terminal_user
from cellctl.config import CellConfig, load_cell
from cellctl.errors.calibration import CalibrationMissing
from cellctl.errors.records.store import StoreUnavailable
from cellctl.records.entered.said_by import BY
from cellctl.records.store import RunStore
from cellctl.runtime.process import calibration_kinds
from cellctl.spelling import nearest
from cellctl.terminal.consoles import print_warning


def invalidate(
    name: Annotated[str, typer.Argument(help="head_1, head_2, base_frame, board_transfer, …")],
    *,
    reason: Annotated[str, typer.Option(help="What happened; the operator will read it.")],
    by: Annotated[str, typer.Option(help="Who says so, for the audit log.")] = "operator",
    cell: Annotated[
        Path | None, typer.Option(help=f"The cell's TOML file; default: {SERVICE_CELL}.")
    ] = None,
    calibration_dir: Annotated[
        Path | None, typer.Option(help="Calibrations; default: calibration_dir of the cell file.")
    ] = None,
    data_dir: Annotated[
        Path | None, typer.Option(help="Run store; default: data_dir of the cell file.")
    ] = None,
) -> None:
    """Production refuses to start until the calibration NAME has been made anew.

    Also for a cell that is running: it looks before every start, and before a part is good.
    """
    # The reason is all that an operator will later see of this decision.
    if not reason.strip():
        raise typer.BadParameter("say what happened", param_hint="--reason")
    if cell is None and not os.path.exists(SERVICE_CELL):
        said = f"no {SERVICE_CELL} is seen by this user; name the cell file"
        raise typer.BadParameter(said, param_hint="--cell")
    file = cell or SERVICE_CELL
    config = load_cell(file)
    folder = calibration_dir or file.parent / config.calibration_dir
    store = CalibrationStore(folder, calibration_kinds(config))
    kind = store.named(name)
    # The calibration first and the audit log after it: without the log the cell is still safe from
    # a bad calibration, the other way round it is not.
    found = store.invalidate([kind], f"{reason} ({by})")
    if not found:
        there = store.names()
        raise CalibrationMissing(
            f"{name}: there is no such calibration in {store.path}; {nearest(name, there)}"
            f"there: {', '.join(there) or 'none'}"
        )
    anew = f"made anew by {kind.made_by}" if kind.made_by else "made anew"
    for stored in found:
        typer.echo(f"{stored.kind} is invalid until it is {anew}: {reason}")
    _record(config, data_dir, found, reason, by)


def _record(
    config: CellConfig,
    data_dir: Path | None,
    found: list[StoredCalibration],
    reason: str,
    by: str,
) -> None:
    path = data_dir or Path(config.data_dir)
    try:
        store = RunStore(path, create=False)
    # A cell that has never run has no store; that must not keep anybody from withdrawing a
    # calibration.
    except StoreUnavailable as error:
        print_warning(f"not in the audit log: {error}")
        return
    with closing(store):
        for stored in found:
            store.invalidate_calibration(stored, reason)
        detail = {BY: by, "items": [stored.kind for stored in found], "reason": reason}
        store.audit(terminal_user(), "calibrations invalidated", detail)
