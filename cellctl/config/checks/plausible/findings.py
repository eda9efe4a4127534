"""All findings of the plausibility of a cell file, for whoever commissions the cell."""

from collections.abc import Iterator, Set
from pathlib import Path

from cellctl.config.cell import CellConfig
from cellctl.config.checks.plausible.arms import arm_issues
from cellctl.config.checks.plausible.calibration_files import calibration_file_issues
from cellctl.config.checks.plausible.calibration_folder import calibration_folder_issues
from cellctl.config.checks.plausible.line import line_issues
from cellctl.config.checks.plausible.loads import load_issues
from cellctl.config.checks.plausible.mounted import mounted_issues
from cellctl.config.checks.plausible.places import place_issues
from cellctl.config.checks.plausible.plates import plate_issues
from cellctl.config.checks.plausible.recipes import recipe_issues
from cellctl.config.checks.plausible.sensors import sensor_issues
from cellctl.config.checks.plausible.speed_bounds import speed_bound_issues
from cellctl.config.checks.plausible.waits import wait_issues
from cellctl.config.checks.plausible.ways_out import way_out_issues
from cellctl.config.issue import ConfigIssue


def plausibility_issues(cell: CellConfig, folder: Path, bad: Set[str]) -> Iterator[ConfigIssue]:
    """What belongs to no process.

    ``folder`` is that of the cell file; ``bad`` holds the paths of devices that are wrong
    themselves, of which nothing more is said where their drivers would have to be asked.
    """
    yield from arm_issues(cell, bad)
    yield from plate_issues(cell)
    yield from mounted_issues(cell)
    yield from load_issues(cell)
    yield from way_out_issues(cell, bad)
    yield from line_issues(cell)
    yield from sensor_issues(cell, bad)
    yield from recipe_issues(cell)
    yield from wait_issues(cell, bad)
    yield from speed_bound_issues(cell, bad)
    yield from place_issues(cell, folder)
    yield from calibration_folder_issues(cell, folder)
    yield from calibration_file_issues(cell, folder)
