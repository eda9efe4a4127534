"""Check of cameras whose exposure is to be found: their drivers must be able to set one."""

from collections.abc import Iterator, Mapping

from cellctl.config.cell import CellConfig
from cellctl.config.devices import CameraConfig
from cellctl.config.driver_settings import sets_exposures
from cellctl.config.issue import ConfigIssue


def exposure_issues(cell: CellConfig) -> Iterator[ConfigIssue]:
    """Cameras and heads with ``auto_exposure`` and a driver that cannot set an exposure."""
    sections: Mapping[str, Mapping[str, CameraConfig]] = {
        "cameras": cell.cameras,
        "stereo_cameras": cell.stereo_cameras,
    }
    for section, cameras in sections.items():
        for name, camera in cameras.items():
            if camera.auto_exposure is not None and not sets_exposures(section, camera):
                allowed = f"driver {camera.driver} cannot set exposures; gige can"
                yield ConfigIssue(f"{section}.{name}.auto_exposure", "a setting", allowed)
