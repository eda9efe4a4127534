"""`cellctl plan viewpoints`: where the heads of a cell look from, for a person's review."""

from pathlib import Path
from typing import Annotated

import typer

from cellctl.cli.planning.opening import CellFile, ModelFile, open_scene
from cellctl.errors.config import NoViewsStated
from cellctl.files.hand_written import read_hand_written
from cellctl.terminal.consoles import console_of_lines

Out = Annotated[
    Path | None, typer.Option("--out", help="Write the cell file with the poses here; else none.")
]


def viewpoints(cell_file: CellFile, model: ModelFile = None, out: Out = None) -> None:
    """Plan from where each head measures, by how certain the measured pose will be.

    What is written has to be read by a person and tried at low speed, and what is calibrated at
    these poses (the board transfer) is void then.
    """
    scene = open_scene(cell_file, model)
    # The libraries of planning may be missing, which opening the scene says.
    from cellctl.calibration.output_file import write_file
    from cellctl.planning.views.gains import gains
    from cellctl.planning.views.plan_viewpoints import ViewpointPlan, stated_measurements
    from cellctl.planning.views.view_text import gain_line, views_lines
    from cellctl.planning.views.write_viewpoints import with_viewpoints_written

    console = console_of_lines()
    planned = []
    for measurement in stated_measurements(scene):
        views = ViewpointPlan(scene, measurement).search()
        planned.append(views)
        for line in views_lines(views):
            console.print(line)
        console.print("with other equipment:")
        for gain in gains(scene, views.placement):
            console.print(gain_line(gain))
    if not planned:
        raise NoViewsStated(f"{cell_file}")
    if out is not None:
        text = read_hand_written(cell_file)
        write_file(out, with_viewpoints_written(text, planned).encode())
        console.print(f"written: {out}; read it, try each pose at low speed, and calibrate there")
