"""Check of cameras whose exposure is to be found: their drivers must be able to set one."""

from collections.abc import Iterator

from cellctl.config.cell import CellConfig
from cellctl.config.devices import CameraConfig
from cellctl.config.driver_settings import sets_exposures
from cellctl.config.issue import ConfigIssue


def exposure_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Cameras and heads with ``auto_exposure`` and a driver that cannot set an exposure."""
    for path, (group, device) in cell.devices().items():
        if not isinstance(device, CameraConfig) or device.auto_exposure is None:
            continue
        if not sets_exposures(group, device):
            allowed = f"driver {device.driver} cannot set exposures; gige can"
            yield ConfigIssue(f"{path}.auto_exposure", "a setting", allowed)
