"""Cameras whose images would not come, or would be looked at in a wrong unit."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.devices import CameraConfig
from cellctl.config.issue import ConfigIssue

_PRODUCER = ".cti"
"""Ends the file of a GenTL producer (GenICam GenTL standard, "Installation"), by which every
program finds it; drivers that load producers have them in a setting of this name."""
_LONG_SETTLE_S = 3.0
"""Lamps of metal halide take longer to their full light, and nobody switches these for a look."""
LEAST_HOLE_PX = 15.0
"""Radius; the smallest holes that the demonstration measures have 16 px, and in millimetres most
holes are smaller than this."""


def camera_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Paths that are no GenTL producer: a folder, or another library of the maker."""
    for path, (_, device) in cell.devices().items():
        named = device.settings.get("producers")
        for one in named if isinstance(named, list | tuple) else ():
            if not str(one).endswith(_PRODUCER):
                allowed = f"files of GenTL producers, which end in {_PRODUCER}"
                yield ConfigIssue(f"{path}.settings.producers", repr(str(one)), allowed)


def camera_remarks(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Looks that take long, and holes that are hardly seen."""
    for path, (_, device) in cell.devices().items():
        if not isinstance(device, CameraConfig):
            continue
        if device.light is not None and device.light.settle_s > _LONG_SETTLE_S:
            said = "in seconds, and each look waits so long for the lamp: LEDs take milliseconds"
            yield ConfigIssue(f"{path}.light.settle_s", f"{device.light.settle_s:g}", said)
        wanted = device.auto_exposure
        if wanted is not None and wanted.hole_px[1] < LEAST_HOLE_PX:
            said = (
                "radii in pixels of the image, and not in mm: right if the holes are so small in it"
            )
            yield ConfigIssue(f"{path}.auto_exposure.hole_px", str(list(wanted.hole_px)), said)
