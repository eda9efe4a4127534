"""What is missing on this PC, and may be right on that of the cell."""

import grp
import os
from pathlib import Path

from cellctl.config import CellConfig
from cellctl.files.atomic_files import may_write


def hints_of_this_pc(cell: CellConfig, folder: Path) -> list[str]:
    """What the daemon needs of the PC that it will run on, as far as it is missing here.

    ``folder`` is that of the cell file.
    """
    folders = {"data_dir": Path(cell.data_dir), "calibration_dir": folder / cell.calibration_dir}
    hints = [
        f"{key} {path}: this user may not write it, the daemon's must"
        for key, path in folders.items()
        if not may_write(path)
    ]
    calibrations = folders["calibration_dir"]
    if not any(calibrations.glob("*.json")):
        there = "holds no calibration" if calibrations.is_dir() else "no such folder on this PC"
        hints.append(
            f"calibration_dir {calibrations}: {there}: right for a cell that is still to be "
            "calibrated; what checks hold against calibrations was not checked"
        )
    processors = os.cpu_count() or 1
    hints += [
        f"force_sensors.{name}.cpu {sensor.cpu}: this PC has processors 0 to {processors - 1}"
        for name, sensor in cell.force_sensors.items()
        if sensor.cpu is not None and sensor.cpu >= processors
    ]
    group = cell.local_api.group
    if group and not _is_group(group):
        hints.append(f"local_api.group {group}: this PC has no such group, the cell's must")
    return hints


def _is_group(name: str) -> bool:
    try:
        grp.getgrnam(name)
    except KeyError:
        return False
    return True
