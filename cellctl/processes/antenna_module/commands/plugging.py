"""`cellctl plan-plug`, `calibrate plug`, `calibrate tool-turn`, and what judges a plug's curve.

Exit codes: 0 planned or calibrated; 3 when a result was found but is not good; 1 for a
fault, which is named with its number.
"""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Protocol, TypeVar

import typer

from cellctl.calibration.checks import Checks
from cellctl.calibration.input_file import read_input
from cellctl.calibration.judged_insertion import JudgedInsertion
from cellctl.calibration.output_file import write_file
from cellctl.errors.calibration import CalibrationRecordInvalid
from cellctl.errors.config import FileInvalid
from cellctl.files.hand_written import read_hand_written
from cellctl.geometry.pose import pose_to_xyzabc
from cellctl.processes.antenna_module.chain.plan import ContactPattern, PlugTolerance, plan_plug
from cellctl.processes.antenna_module.chain.schemes import SCHEMES, Scheme
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.taught_check import checked_with
from cellctl.processes.antenna_module.chain.teaching.teaching import teach_plug
from cellctl.processes.antenna_module.chain.teaching.tool_turn import calibrate_tool_turn
from cellctl.processes.antenna_module.commands.trial_file import (
    TeachFile,
    TrialFile,
    looks_of,
    read_cell_file,
)
from cellctl.processes.antenna_module.commands.turn_file import TurnFile
from cellctl.processes.antenna_module.connector.connector import read_connector
from cellctl.processes.antenna_module.faults.connector import ConnectorFileInvalid
from cellctl.processes.antenna_module.faults.plugging import InsertionCurveInvalid
from cellctl.processes.antenna_module.insertion.curve import parse_curve
from cellctl.processes.antenna_module.insertion.possible import (
    require_possible_curve,
    unknown_zero,
)
from cellctl.processes.antenna_module.insertion.verdict import InsertionVerdict, judge_insertion

T = TypeVar("T")
NOT_GOOD = 3
"""Exit code when there is a result, but a figure of it is beyond its limit."""
PANEL = "From files, without a cell"

InFile = Annotated[Path, typer.Option("--in", help="Input file, see docs/plugging.md.")]
OutFile = Annotated[Path | None, typer.Option("--out", help="Write the result to this JSON file.")]


def add_plan_plug(app: typer.Typer) -> None:
    """Add the command to an application."""
    app.command("plan-plug", rich_help_panel=PANEL)(plan_plug_from_file)


def add_calibrate_plug(app: typer.Typer) -> None:
    """Add the command to `cellctl calibrate`."""
    app.command("plug")(calibrate_plug)


def add_calibrate_tool_turn(app: typer.Typer) -> None:
    """Add the command to `cellctl calibrate`."""
    app.command("tool-turn")(calibrate_turn)


def plan_plug_from_file(
    file: InFile,
    connector: Annotated[
        Path | None, typer.Option(help="Drawing of the plug, TOML; else the file's 'connector'.")
    ] = None,
    out: OutFile = None,
) -> None:
    """Where the flange goes to plug a connector, with the predicted error of its worst contact."""
    trial = read_cell_file(file, TrialFile)
    named = trial.connector
    if connector is None and named is None:
        raise FileInvalid(f"{file}: missing 'connector'; or give --connector")
    drawing = read_connector(connector or file.parent / str(named))
    looks = _valued(file, lambda: looks_of(trial.looks))
    if looks.plug.connector != drawing.name:
        raise FileInvalid(f"{file}: the plug is a {looks.plug.connector}, not a {drawing.name}")
    plan = plan_plug(
        looks,
        trial.cell(),
        _scheme(file, trial.scheme),
        ContactPattern(drawing.contacts, drawing.positions_m),
        now_s=trial.now_s(),
        correction=_correction(file, trial.correction),
        tolerance=PlugTolerance(worst_contact_m=trial.tolerance_um * 1e-6),
    )
    x, y, z, a, b, c = pose_to_xyzabc(plan.base_T_flange.pose)
    _say(f"base_T_flange: X {x:.4f}, Y {y:.4f}, Z {z:.4f} mm, A {a:.5f}, B {b:.5f}, C {c:.5f}°")
    _say(f"worst contact {plan.worst.name}: 99 % within {plan.worst.p99_m * 1e6:.1f} µm")
    for term, value_m in sorted(plan.terms_m.items(), key=lambda item: -item[1]):
        _say(f"  {term}: {value_m * 1e6:.1f} µm")
    _write(out, plan.to_record())


def judge_by_connector(curve: Path, connector: Path) -> JudgedInsertion:
    """The judge of `cellctl judge-insertion --connector`; raises ``InsertionCurveInvalid`` and the
    faults of a drawing."""
    try:
        text = read_hand_written(curve)
    except OSError as error:
        raise InsertionCurveInvalid(f"{curve}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise InsertionCurveInvalid(
            f"{curve}: not UTF-8 (byte {error.start + 1}); save it as CSV in UTF-8"
        ) from error
    drawing = read_connector(connector)
    if drawing.kind != "holes":
        # By the plug's drawing, the mirror image, the other end of the row would be suspected.
        raise ConnectorFileInvalid(
            f"{connector}: {drawing.name} has {drawing.kind}, not holes; give the socket's drawing:"
            " a curve is in the axes of the socket (docs/plugging.md)"
        )
    try:
        read = parse_curve(text)
        require_possible_curve(read, drawing)
    except InsertionCurveInvalid as fault:
        raise InsertionCurveInvalid(f"{curve}: {fault.detail}") from fault
    judgement = judge_insertion(read, drawing)
    open_zero = unknown_zero(read, drawing)
    said = () if open_zero is None else (open_zero,)
    return JudgedInsertion(
        judgement.verdict.value,
        judgement.verdict is InsertionVerdict.SEATED,
        judgement.checks,
        judgement.fault,
        judgement.to_record() | {"left_open": list(said)},
        said,
    )


def calibrate_plug(
    file: InFile,
    out: OutFile = None,
    picture: Annotated[Path | None, typer.Option(help="Write the evidence as PNG.")] = None,
) -> None:
    """The correction from taught plugs: what all constant errors of a cell come to at a slot."""
    data = read_cell_file(file, TeachFile)
    correction = teach_plug(
        _valued(file, data.by_slot),
        data.cell(),
        _scheme(file, data.scheme),
        range_m=data.range_mm * 1e-3,
    )
    checked = _valued(file, data.checked)
    correction = checked_with(correction, checked, data.cell(), _scheme(file, data.scheme))
    for slot in correction.slots:
        x, y, z = slot.socket_T_plug.pose.translation * 1e3
        _say(f"slot {slot.name}: {x:.4f}, {y:.4f}, {z:.4f} mm from {slot.plugs} plugs")

    def draw() -> bytes:
        # Here, because every command of `cellctl` loads this module and few of them draw.
        from cellctl.processes.antenna_module.chain.teaching.taught_picture import taught_picture

        return taught_picture(correction)

    _keep(correction, out, picture, draw)


def calibrate_turn(
    file: InFile,
    out: OutFile = None,
    picture: Annotated[Path | None, typer.Option(help="Write the evidence as PNG.")] = None,
) -> None:
    """Where a feature of the gripper lies beside the flange axis, from turns before camera II."""
    result = calibrate_tool_turn([entry.stop() for entry in read_input(file, TurnFile).turns])
    x, y = result.offset_m * 1e3
    _say(f"offset {x:.4f}, {y:.4f} mm, sigma {result.sigma_m * 1e6:.1f} µm")

    def draw() -> bytes:
        from cellctl.processes.antenna_module.chain.teaching.turn_picture import turn_picture

        return turn_picture(result)

    _keep(result, out, picture, draw)


class _Calibrated(Protocol):
    @property
    def checks(self) -> Checks: ...
    @property
    def passed(self) -> bool: ...
    def to_record(self) -> dict[str, Any]: ...


def _keep(
    result: _Calibrated, out: Path | None, picture: Path | None, draw: Callable[[], bytes]
) -> None:
    """Show and write a result with its picture; the exit code says whether it passed."""
    _show_checks(result.checks)
    _write(out, result.to_record())
    if picture is not None:
        write_file(picture, draw())
    if not result.passed:
        raise typer.Exit(NOT_GOOD)


def _scheme(file: Path, name: str) -> Scheme:
    if name not in SCHEMES:
        raise FileInvalid(f"{file}: no scheme {name!r}; there are {', '.join(SCHEMES)}")
    return SCHEMES[name]


def _correction(file: Path, record: Mapping[str, Any] | None) -> PlugCorrection | None:
    if record is None:
        return None
    try:
        return PlugCorrection.from_record(record)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise CalibrationRecordInvalid(f"{file}: plug correction: {error!r}") from error


def _valued(file: Path, make: Callable[[], T]) -> T:
    """What the content of a file comes to; raises ``FileInvalid`` with its place."""
    try:
        return make()
    except ValueError as error:
        raise FileInvalid(f"{file}: {error}") from error


def _show_checks(checks: Checks) -> None:
    for check in checks:
        _say(f"  {'ok  ' if check.passed else 'FAIL'}  {check}")


def _say(text: str) -> None:
    typer.echo(text)


def _write(out: Path | None, record: Mapping[str, Any]) -> None:
    if out is not None:
        write_file(out, (json.dumps(record, indent=2, allow_nan=False) + "\n").encode())
