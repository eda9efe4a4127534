"""The whole cell file."""

import ipaddress
import os
from collections.abc import Mapping
from typing import Annotated, Literal, Self
from urllib.parse import parse_qsl, urlsplit

from pydantic import Field, SerializeAsAny, field_validator, model_validator

from cellctl import plugins
from cellctl.config.base import Section
from cellctl.config.devices import (
    GROUPS,
    CameraConfig,
    DeviceConfig,
    DeviceName,
    DigitalIoConfig,
    ForceSensorConfig,
    GripperConfig,
    RobotConfig,
    StereoCameraConfig,
    TrackerConfig,
)
from cellctl.config.recipe import Recipe
from cellctl.config.zones import ZoneConfig

_SECRETS = frozenset({"password", "passfile", "sslpassword"})


MOST_SOCKET_BYTES = 107
"""Longest path of a socket: the kernel's limit (``sun_path``, 108 bytes with the final zero)."""


class Plc(Section):
    """Modbus TCP towards the line."""

    host: str = "127.0.0.1"
    """Address of this PC at which the line connects."""
    port: Annotated[int, Field(ge=0, le=65535)] = 502
    """Below 1024 only the service may listen, or root."""
    word_order: Literal["big", "little"] = "big"
    """Order of the two words of a 32-bit value."""
    heartbeat_timeout_s: Annotated[float, Field(ge=0.5, le=10)] = 1.5
    """Time without a new value of the line's heartbeat after which the line counts as lost."""
    allowed_clients: tuple[str, ...] = ()
    """Addresses or networks that may connect, and so may start the cell (``0.0.0.0/0``: everybody
    in the network); may be empty where only this PC can connect. Names are not looked up."""

    @field_validator("allowed_clients")
    @classmethod
    def _clients_are_addresses(cls, clients: tuple[str, ...]) -> tuple[str, ...]:
        for client in clients:
            # Names are refused: looking them up can block, and whoever answers for them decides who
            # may connect.
            ipaddress.ip_network(client, strict=False)
        return clients

    @model_validator(mode="after")
    def _open_only_if_said(self) -> Self:
        # Modbus has no password. Whoever reaches the port could command the cell, so that must be
        # said and not come from a line that was forgotten.
        if not self.allowed_clients and not _is_this_pc_alone(self.host):
            raise ValueError(
                "allowed_clients must list the line's address when host is not of this PC alone: "
                "Modbus asks no password, and whoever may connect may start the cell"
            )
        return self


def _is_this_pc_alone(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class LocalApi(Section):
    """Operator commands on the cell's PC."""

    socket: str = ""
    """Relative to the working directory of the daemon; empty: `cellctl.sock` in the runtime
    directory of the service, else in data_dir."""
    group: str = ""
    """Group whose members may command the cell; empty for the group of the daemon."""
    page_user: str = "cellctl-hmi"
    """The user of the operator page's process; it may say which person asks. The daemon's own user
    may, too."""

    @field_validator("socket")
    @classmethod
    def _fits_the_kernel(cls, value: str) -> str:
        if (written := len(os.fsencode(value))) > MOST_SOCKET_BYTES:
            raise ValueError(f"a path of at most {MOST_SOCKET_BYTES} bytes; this one has {written}")
        return value


class FleetConfig(Section):
    """The database of all cells, to which a program beside the daemon delivers the records."""

    url: Annotated[str, Field(max_length=500)]
    """``postgresql://USER@HOST:PORT/DATABASE``, with options of libpq behind a question mark. It
    has no password: cell files are copied, sent and kept in records."""
    password_file: str = ""
    """Absolute path; the first line there is the password. Empty: the environment has it."""

    @field_validator("url")
    @classmethod
    def _names_a_database_and_no_password(cls, url: str) -> str:
        return checked_url(url)


def checked_url(url: str) -> str:
    """The URL of a fleet database; raises ``ValueError``, whose text never holds a password."""
    try:
        parts = urlsplit(url)
        password, user, host = parts.password, parts.username, parts.hostname
        _ = parts.port
    except ValueError:
        # The reason is left out, because it may quote the password that stands before the @.
        raise ValueError("it reads postgresql://USER@HOST:PORT/DATABASE") from None
    if password is not None or _SECRETS & {key for key, _ in parse_qsl(parts.query)}:
        raise ValueError("a password does not belong here; give password_file or the environment")
    if parts.scheme != "postgresql" or not (user and host and parts.path.strip("/")):
        raise ValueError("it reads postgresql://USER@HOST:PORT/DATABASE")
    return url


class CellConfig(Section):
    """Everything the daemon needs to know about one cell."""

    name: Annotated[str, Field(min_length=1, max_length=64)]
    """Of this cell, on screens and reports, and among the cells of a fleet."""
    data_dir: str = "runs"
    """Run store and artefacts, relative to the working directory of the daemon."""
    calibration_dir: str = "calibration"
    """Folder of the calibrations, relative to the cell file."""
    plc: Plc = Plc()
    local_api: LocalApi = LocalApi()
    fleet: FleetConfig | None = None
    """Database of the fleet; the daemon does not look at it."""
    robots: dict[DeviceName, RobotConfig] = Field(default_factory=dict)
    stereo_cameras: dict[DeviceName, StereoCameraConfig] = Field(default_factory=dict)
    cameras: dict[DeviceName, CameraConfig] = Field(default_factory=dict)
    trackers: dict[DeviceName, TrackerConfig] = Field(default_factory=dict)
    force_sensors: dict[DeviceName, ForceSensorConfig] = Field(default_factory=dict)
    grippers: dict[DeviceName, GripperConfig] = Field(default_factory=dict)
    digital_ios: dict[DeviceName, DigitalIoConfig] = Field(default_factory=dict)
    zones: dict[DeviceName, ZoneConfig] = Field(default_factory=dict)
    """Spaces that two arms may not share, by name."""
    processes: dict[str, SerializeAsAny[Section]] = Field(default_factory=dict)
    """Settings of the processes by name, those for all of their recipes; each process checks its
    own."""
    recipes: tuple[SerializeAsAny[Recipe], ...] = ()
    """Recipes, each as the recipe model of its own process."""

    def section(self, name: str) -> Mapping[str, DeviceConfig]:
        """The devices of one section, by name."""
        devices: Mapping[str, DeviceConfig] = getattr(self, name)
        return devices

    def devices(self) -> dict[str, tuple[str, DeviceConfig]]:
        """Every device by its path in the file, with the group of its driver."""
        found: dict[str, tuple[str, DeviceConfig]] = {}
        for section, group in GROUPS.items():
            for name, device in self.section(section).items():
                found[f"{section}.{name}"] = group, device
                # The guard's line to the robot has a driver of its own, although it is written
                # inside the sensor.
                if isinstance(device, ForceSensorConfig):
                    stop_channel = plugins.STOP_CHANNEL, device.stop_channel
                    found[f"{section}.{name}.stop_channel"] = stop_channel
        return found

    @property
    def simulated(self) -> bool:
        """True when the devices are fakes: all of them are, or none."""
        # ``any`` is enough, because the cross checks refuse a cell in which some are real and some
        # are not.
        return any(device.simulated for _, device in self.devices().values())

    def recipe(self, recipe_id: int) -> Recipe | None:
        """The recipe with this number."""
        return next((recipe for recipe in self.recipes if recipe.id == recipe_id), None)
