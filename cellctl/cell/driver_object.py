"""Builds the drivers of a cell file."""

from collections.abc import Callable
from typing import Any, TypeVar

from cellctl import plugins
from cellctl.config import CellConfig
from cellctl.config.devices import GROUPS, DeviceConfig

Layered = TypeVar("Layered")


def driver_object(section: str, name: str, device: DeviceConfig) -> Any:
    """The driver, not connected; its settings were validated when the cell file was loaded.

    ``section`` is that of the cell file, such as ``cameras``. Raises ``UnknownDriver``.
    """
    driver: Any = plugins.load(GROUPS[section], device.driver)
    return driver(name, driver.Config.model_validate(device.settings))


def drivers_of(
    config: CellConfig, section: str, layered: Callable[[Any], Layered]
) -> dict[str, Layered]:
    """The drivers of a section by name, each behind a layer; raises ``UnknownDriver``."""
    devices = config.section(section)
    return {name: layered(driver_object(section, name, one)) for name, one in devices.items()}
