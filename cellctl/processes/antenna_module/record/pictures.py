"""Annotated pictures of what was measured, as artefacts of the run."""

from cellctl.processes.antenna_module.looking import Seen
from cellctl.processes.antenna_module.run import PluggingRun
from cellctl.processes.antenna_module.vision.measurement import ConnectorMeasurement
from cellctl.processes.antenna_module.vision.picture import picture_of


async def record_picture(run: PluggingRun, name: str, seen: Seen[ConnectorMeasurement]) -> None:
    """The last image of a look with a circle by state on every contact."""
    picture = await run.cell.workers.run(picture_of, seen.images[-1], seen.frames[-1])
    await run.recorder.artefact(run.prefix + name, picture, "image/png")
