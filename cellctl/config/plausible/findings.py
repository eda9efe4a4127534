"""All findings of the plausibility of a cell file, for whoever commissions the cell."""

from collections.abc import Iterator, Set
from pathlib import Path

from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.plausible.arms import arm_issues
from cellctl.config.plausible.mounted import mounted_issues
from cellctl.config.plausible.places import place_issues
from cellctl.config.plausible.sensors import sensor_issues
from cellctl.config.plausible.waits import wait_issues


def plausibility_issues(cell: CellConfig, folder: Path, bad: Set[str]) -> Iterator[ConfigIssue]:
    """What belongs to no process.

    ``folder`` is that of the cell file; ``bad`` holds the paths of devices that are wrong
    themselves, of which nothing more is said where their drivers would have to be asked.
    """
    yield from arm_issues(cell, bad)
    yield from mounted_issues(cell)
    yield from sensor_issues(cell, bad)
    yield from wait_issues(cell)
    yield from place_issues(cell, folder)
