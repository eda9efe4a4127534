"""Checks of the digital outputs that robots and cameras use: the permit of an arm, a lamp."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cellctl.config.cell import CellConfig
from cellctl.config.devices import CameraConfig
from cellctl.config.driver_settings import io_names
from cellctl.config.issue import ConfigIssue
from cellctl.spelling import nearest


@dataclass(frozen=True, slots=True)
class _Use:
    """The use of an output by something in the cell file."""

    key: str
    """Key of the table that names device and output."""
    device: str
    output: str


def output_issues(cell: CellConfig, found: Sequence[ConfigIssue]) -> Iterator[ConfigIssue]:
    """Outputs that are not there, and permits that something else switches too.

    ``found`` is what is wrong with the sections themselves.
    """
    permits, lights = list(_permits(cell)), list(_lights(cell))
    for use in (*permits, *lights):
        yield from _is_there(cell, use, found)
    times = Counter((use.device, use.output) for use in permits)
    for use in permits:
        if times[use.device, use.output] > 1:
            yield ConfigIssue(f"{use.key}.output", repr(use.output), "one contact for each robot")
    for use in lights:
        # The end of an exposure would take the arm's permit away, or its beginning give it.
        if (use.device, use.output) in times:
            yield ConfigIssue(f"{use.key}.output", repr(use.output), "not the permit of a robot")


def _permits(cell: CellConfig) -> Iterator[_Use]:
    for name, robot in cell.robots.items():
        if robot.permit is not None:
            yield _Use(f"robots.{name}.permit", robot.permit.device, robot.permit.output)


def _lights(cell: CellConfig) -> Iterator[_Use]:
    for path, (_, device) in cell.devices().items():
        if isinstance(device, CameraConfig) and device.light is not None:
            yield _Use(f"{path}.light", device.light.device, device.light.output)


def _is_there(cell: CellConfig, use: _Use, found: Sequence[ConfigIssue]) -> Iterator[ConfigIssue]:
    if use.device not in cell.digital_ios:
        ios = ", ".join(cell.digital_ios) or "none"
        allowed = f"{nearest(use.device, cell.digital_ios)}one of digital_ios: {ios}"
        yield ConfigIssue(f"{use.key}.device", repr(use.device), allowed)
        return
    section = f"digital_ios.{use.device}"
    if any(issue.key.startswith((f"{section}.driver", f"{section}.settings")) for issue in found):
        return  # its signals are not known
    names = io_names(cell.digital_ios[use.device])
    if names is None or use.output in names.outputs:
        return
    outputs = ", ".join(names.outputs) or "none"
    why = f"{use.output} is an input; " if use.output in names.inputs else ""
    allowed = f"{why}{nearest(use.output, names.outputs)}an output of {use.device}: {outputs}"
    yield ConfigIssue(f"{use.key}.output", repr(use.output), allowed)
