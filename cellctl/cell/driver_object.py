"""Builds the drivers of the devices of a cell file."""

from typing import Any

from cellctl import plugins
from cellctl.config.cell import CellConfig
from cellctl.config.devices import GROUPS, DeviceConfig


def driver_object(section: str, name: str, device: DeviceConfig) -> Any:
    """The driver, not connected; its settings were validated when the cell file was loaded.

    ``section`` is that of the cell file, such as ``cameras``. Raises ``UnknownDriver``.
    """
    driver: Any = plugins.load(GROUPS[section], device.driver)
    return driver(name, driver.Config.model_validate(device.settings))


def drivers_of(config: CellConfig, section: str) -> dict[str, Any]:
    """Of all devices of one section by their names; raises as ``driver_object``."""
    devices = config.section(section)
    return {name: driver_object(section, name, device) for name, device in devices.items()}
