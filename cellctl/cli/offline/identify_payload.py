"""`cellctl identify-payload`: the payload from a file of still poses and wrenches."""

import json
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from cellctl.calibration.output_file import write_file
from cellctl.cli.offline.calibration_output import print_checks
from cellctl.errors.force import PayloadFileInvalid, PosesDegenerate
from cellctl.force.gravity.payload_result import PayloadResult, evaluate_payload, payload_document
from cellctl.force.gravity.pose_file import PoseRecord, parse_pose_file
from cellctl.force.gravity.poses import PoseRole
from cellctl.force.gravity.signs import lever_check, lever_words
from cellctl.force.gravity.written_otherwise import scalar_first_hint, unit_hint
from cellctl.geometry.pose import MM
from cellctl.procedures.payload_picture import residual_picture
from cellctl.terminal.consoles import console_of_lines, print_hanging

NOT_ACCEPTED = 3
"""Exit code when the payload was identified but failed its acceptance."""


def identify_payload(
    file: Annotated[
        Path,
        typer.Argument(
            help="CSV with qx,qy,qz,qw of base_T_sensor and fx_n,fy_n,fz_n,mx_nm,my_nm,mz_nm; "
            "optional column role: fit, hold-out or repeat."
        ),
    ],
    out: Annotated[Path | None, typer.Option(help="Write the result to this JSON file.")] = None,
    picture: Annotated[Path | None, typer.Option(help="Write the residuals as PNG.")] = None,
    mass_kg: Annotated[float | None, typer.Option(help="Mass that CAD says, to compare.")] = None,
    *,
    load_on_top: Annotated[
        bool, typer.Option("--load-on-top", help="The load stands on the sensor, it does not hang.")
    ] = False,
) -> None:
    """Identify mass, centre of mass, offsets and gravity compensation from still poses.

    Exit code 3 when the result fails its acceptance, or its units look like others; it is written
    all the same.
    """
    record = parse_pose_file(_read(file))
    try:
        result = evaluate_payload(record, expected_mass_kg=mass_kg)
    except PosesDegenerate as fault:
        if hint := scalar_first_hint(record):
            raise PayloadFileInvalid(f"{file}: {hint}") from fault
        raise
    rigid, fit = result.identification.rigid, record.having(PoseRole.FIT)
    lever = lever_check(rigid, fit.base_R_sensor, on_top=load_on_top)
    result = result.also((lever,))
    console = console_of_lines()
    hint = unit_hint(result, mass_kg)
    _show(result, console)
    # A result in other units fits as well as a good one: its own tests do not see them.
    console.print("accepted" if result.accepted and not hint else "NOT accepted")
    _say_what_else(hint or _order_hint(result, record), result, mass_kg, console)
    if not lever.passed:
        words = lever_words(rigid, fit.base_R_sensor)
        print_hanging(console, f"note: {words}", 6, "yellow")
    if out is not None:
        write_file(out, json.dumps(payload_document(result), indent=2).encode() + b"\n")
    if picture is not None:
        write_file(picture, residual_picture(result))
    if hint or not result.accepted:
        raise typer.Exit(NOT_ACCEPTED)


def _order_hint(result: PayloadResult, record: PoseRecord) -> str:
    return "" if result.accepted else scalar_first_hint(record)


def _read(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise PayloadFileInvalid(f"{file}: {error}") from error


def _show(result: PayloadResult, console: Console) -> None:
    rigid, affine = result.identification.rigid, result.identification.affine
    excitation = result.identification.excitation
    table = Table("quantity", "value", show_header=False, title="Payload")
    centre = ", ".join(f"{value / MM:.2f}" for value in rigid.centre_of_mass_m)
    table.add_row("poses used", str(result.identification.poses))
    table.add_row("mass", f"{rigid.mass_kg:.3f} kg")
    table.add_row("centre of mass", f"({centre}) mm")
    table.add_row("force offset", _numbers(rigid.force_offset_n) + " N")
    table.add_row("torque offset", _numbers(rigid.torque_offset_n_m) + " N·m")
    inclinations = np.rad2deg([rigid.inclination_u_rad, rigid.inclination_v_rad])
    table.add_row("inclination U, V", f"{inclinations[0]:.3f}°, {inclinations[1]:.3f}°")
    model = affine.compensation
    table.add_row(
        "affine24 residual rms", f"{model.residual_n:.3f} N, {model.residual_n_m:.3f} N·m"
    )
    table.add_row(
        "condition rigid12, affine24",
        f"{excitation.condition_rigid12:.1f}, {excitation.condition_affine24:.1f}",
    )
    console.print(table)
    # Without this note a weight that points up would look like a mistake.
    if rigid.reads_reaction:
        note = (
            "note: weight points up in this file, so it states reactions, not loads: in a cell a "
            "contact would read as a pull. Set 'inverted' of the sensor's settings otherwise; "
            "procedure 106 accepts no such sensor"
        )
        print_hanging(console, note, 6)
    print_checks(console, result.checks)


def _say_what_else(
    hint: str, result: PayloadResult, mass_kg: float | None, console: Console
) -> None:
    """What the tests do not find: another unit, another order, a mass that nobody compared."""
    if hint:
        print_hanging(console, f"note: {hint}", 6, "yellow")
    if mass_kg is None:
        found_kg = result.identification.rigid.mass_kg
        text = (
            f"note: nothing here has checked mass and units: compare {found_kg:.3g} kg with the "
            "drawing, or give it by --mass-kg"
        )
        print_hanging(console, text, 6, "yellow")


def _numbers(values: object) -> str:
    return "(" + ", ".join(f"{value:.3f}" for value in np.asarray(values)) + ")"
