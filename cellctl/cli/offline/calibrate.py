"""`cellctl calibrate`: the calibrations of Maintenance mode, from files.

Exit code 3 when a result was found but is beyond its limits; it is written all the same.
"""

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from cellctl.calibration.input_file import read_input
from cellctl.calibration.solvers.base_frame.base_frame import ArmGeometry, calibrate_base_frame
from cellctl.calibration.solvers.base_frame.base_frame_input import BaseFrameFile
from cellctl.calibration.solvers.base_frame.base_frame_mistakes import (
    explanation as base_frame_mistake,
)
from cellctl.calibration.solvers.base_frame.base_frame_picture import base_frame_picture
from cellctl.calibration.solvers.hand_eye.hand_eye import calibrate_hand_eye
from cellctl.calibration.solvers.hand_eye.hand_eye_input import HandEyeFile
from cellctl.calibration.solvers.hand_eye.hand_eye_picture import hand_eye_picture
from cellctl.calibration.solvers.hand_eye.hand_eye_result import Setup
from cellctl.calibration.solvers.tool.tool import calibrate_tool
from cellctl.calibration.solvers.tool.tool_input import ToolFile
from cellctl.calibration.solvers.tool.tool_mistakes import tool_mistakes
from cellctl.calibration.solvers.tool.tool_picture import tool_picture
from cellctl.calibration.solvers.transfer.board_transfer import calibrate_board_transfer
from cellctl.calibration.solvers.transfer.transfer_input import TransferFile
from cellctl.calibration.solvers.transfer.transfer_mistakes import (
    inverted_base,
    require_unmistaken,
)
from cellctl.calibration.solvers.transfer.transfer_picture import transfer_picture
from cellctl.cli.offline.calibrate_cameras import camera, stereo
from cellctl.cli.offline.calibration_output import Picture, finish
from cellctl.cli.offline.heads_of_cell import compare_heads
from cellctl.cli.offline.invalidate import invalidate
from cellctl.cli.offline.seal_calibrations import seal
from cellctl.config import load_cell
from cellctl.config.driver_settings import first_link_mm
from cellctl.errors.calibration import AxisMotionInvalid
from cellctl.errors.config import FileInvalid
from cellctl.geometry.pose import MM, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.terminal.consoles import console_of_lines, print_hanging

app = typer.Typer(help="Calibrate from files.", no_args_is_help=True, rich_markup_mode=None)

app.command("stereo")(stereo)
app.command("camera")(camera)
app.command("invalidate")(invalidate)
app.command("seal")(seal)

InFile = Annotated[Path, typer.Option("--in", help="Input file, see docs/calibration.md.")]
OutFile = Annotated[Path | None, typer.Option("--out", help="Write the result to this JSON file.")]


@app.command("hand-eye")
def hand_eye(
    file: InFile,
    setup: Annotated[Setup | None, typer.Option(help="Overrides the setup in the file.")] = None,
    out: OutFile = None,
    picture: Picture = None,
) -> None:
    """Camera on the flange (AX = XB) or beside the robot (CG = GD), from poses."""
    data = read_input(file, HandEyeFile)
    chosen = setup or data.setup
    if chosen is None:
        raise FileInvalid(f"{file}: missing 'setup'; give --setup eye-in-hand or eye-to-hand")
    result = replace(
        calibrate_hand_eye(data.stops(), chosen, noise=data.robot_noise()),
        camera_id=data.camera_id,
    )
    console = console_of_lines()
    for name, (distance_m, angle_rad) in result.residuals.items():
        mark = "  LEFT OUT" if name in result.rejected else ""
        residual = f"{distance_m / MM:.3f} mm, {np.degrees(angle_rad):.4f}°"
        console.print(f"  {name}: {residual}{mark}")
    in_hand = chosen is Setup.EYE_IN_HAND
    _show("flange_T_camera" if in_hand else "base_T_camera", result.camera)
    _show("base_T_board" if in_hand else "flange_T_board", result.board)
    finish(result, result.warnings, out, picture, lambda: hand_eye_picture(result))


@app.command("base-frame")
def base_frame(
    file: InFile,
    out: OutFile = None,
    picture: Picture = None,
    cell: Annotated[
        Path | None, typer.Option(help="Cell file: d1 and a1 have to be those of an arm in it.")
    ] = None,
) -> None:
    """Base of the robot in the large-field head, from turning A1 and A2."""
    data = read_input(file, BaseFrameFile)
    a1_stops, a2_stops = ([entry.stop() for entry in axis] for axis in (data.a1, data.a2))
    arm = data.arm()
    try:
        result = calibrate_base_frame(a1_stops, a2_stops, arm)
    except AxisMotionInvalid as fault:
        if hint := base_frame_mistake(a1_stops, a2_stops, arm):
            raise FileInvalid(f"{file}: {hint}; then every check passes") from fault
        raise
    hint = "" if result.passed else base_frame_mistake(a1_stops, a2_stops, arm)
    warnings = result.warnings + ((f"{hint}? Then every check passes",) if hint else ())
    _show("C_T_B", result.c_T_base)
    # A1 is found as a line, on which d1 alone says where the base is: no stop can contradict it.
    if cell is not None:
        _compare_with_cell(file, cell, arm)
    else:
        note = (
            f"note: nothing here has checked d1_mm = {arm.d1_m / MM:g}; a wrong one moves the base "
            "along A1 by as much. Compare it with the data sheet, and give --cell"
        )
        print_hanging(console_of_lines(), note, 6, "yellow")
    finish(result, warnings, out, picture, lambda: base_frame_picture(result))


def _compare_with_cell(file: Path, cell_file: Path, arm: ArmGeometry) -> None:
    """Raise ``FileInvalid`` where no arm of a cell has these first links."""
    links = {name: first_link_mm(robot) for name, robot in load_cell(cell_file).robots.items()}
    written = (arm.d1_m / MM, arm.a1_m / MM)
    known = {name: one for name, one in links.items() if None not in one}
    if any(np.allclose(one, written, atol=0.01) for one in known.values()):  # type: ignore[arg-type]
        return
    arms = "; ".join(f"{name}: {d1_mm:g} and {a1_mm:g}" for name, (d1_mm, a1_mm) in known.items())
    raise FileInvalid(
        f"{file}: d1_mm = {written[0]:g} and a1_mm = {written[1]:g} are of no arm in {cell_file}, "
        f"which has {arms or 'none that is described'}"
    )


@app.command("transfer")
def transfer(
    file: InFile,
    out: OutFile = None,
    picture: Picture = None,
    cell: Annotated[
        Path | None, typer.Option(help="Cell file: both heads have to be where it has them.")
    ] = None,
) -> None:
    """Heads I and II in the base by the target board (equations 1 to 3)."""
    data = read_input(file, TransferFile)
    before_head_1, before_head_2 = (data.placements(one) for one in (data.head_1, data.head_2))
    require_unmistaken(str(file), before_head_1, before_head_2)
    result = calibrate_board_transfer(data.base(), before_head_1, before_head_2)
    _show("B_T_C1", result.base_T_c1)
    _show("B_T_C2", result.base_T_c2)
    _show("C1_T_C2", result.c1_T_c2)
    places = {"head_1": result.base_T_c1.pose, "head_2": result.base_T_c2.pose}
    # c_T_base * base_T_head is c_T_head: the heads as a base_T_c in the file would have them.
    if_inverted = {name: data.c_T_base * data.c_T_base * place for name, place in places.items()}
    missing = (
        "give --cell with the cell file of these heads, beside its model"
        if cell is None
        else compare_heads(file, cell, places, if_inverted)
    )
    if missing is not None:
        if (failed := inverted_base(places, if_inverted)) is not None:
            result = replace(result, checks=(*result.checks, failed))
        # In the record too: whoever takes it later sees that nobody has looked.
        unchecked = (
            "nothing here has checked which head is which, nor beyond doubt that c_T_base is not "
            f"its inverse, base_T_c: {missing}"
        )
        result = replace(result, warnings=(*result.warnings, unchecked))
    finish(result, result.warnings, out, picture, lambda: transfer_picture(result))


@app.command("tool")
def tool(file: InFile, out: OutFile = None, picture: Picture = None) -> None:
    """Tool on the flange: four-point method, and three-point method if the file has it."""
    data = read_input(file, ToolFile)
    orienting = data.orienting or ()
    result = calibrate_tool(data.touching, orienting, touch_sigma_m=data.touch_sigma_m)
    warnings = tool_mistakes(data.touching, result)
    _show("flange_T_tool", result.flange_T_tool)
    finish(result, warnings, out, picture, lambda: tool_picture(result))


def _show(name: str, pose: UncertainPose) -> None:
    x, y, z, a, b, c = pose_to_xyzabc(pose.pose)
    sigma = pose.sigma
    # Nothing that was measured is exact: no uncertainty means that the input has not said it.
    turn = f"{np.degrees(sigma[3:].max()):.5f}°" if sigma[3:].any() else "angles not measured"
    text = (
        f"{name}: X {x:.4f}, Y {y:.4f}, Z {z:.4f} mm, A {a:.5f}, B {b:.5f}, C {c:.5f}°; "
        f"sigma {sigma[:3].max() / MM:.4f} mm, {turn}"
    )
    print_hanging(console_of_lines(), text, len(name) + 2)
