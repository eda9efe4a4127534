"""The whole cell file."""

import ipaddress
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from cellctl.config.base import JointsDeg, Section, WrittenPose
from cellctl.config.devices import Device, Force, Heads, Robots
from cellctl.processes.deck_to_frame.recipe import Recipe


class Plc(Section):
    """Modbus TCP towards the line."""

    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=0, le=65535)] = 502
    word_order: Literal["big", "little"] = "big"
    """Order of the two words of a 32-bit value."""
    heartbeat_timeout_s: Annotated[float, Field(ge=0.5, le=10)] = 1.5
    allowed_clients: tuple[str, ...] = ()
    """Addresses or networks that may connect; empty for any. Names are not looked up."""

    @field_validator("allowed_clients")
    @classmethod
    def _clients_are_addresses(cls, clients: tuple[str, ...]) -> tuple[str, ...]:
        for client in clients:
            ipaddress.ip_network(client, strict=False)
        return clients


class LocalApi(Section):
    """Operator commands on the cell's PC."""

    socket: str = ""
    """Relative to the working directory of the daemon; empty: `cellctl.sock` in the runtime
    directory of the service, else in data_dir."""
    group: str = ""
    """Whose members may command the cell; empty for the group of the daemon."""


class Procedures(Section):
    """Settings of the calibration procedures."""

    board: Annotated[str, Field(pattern=r"^\d+x\d+$")] = "9x6"
    """Inner corners of the calibration chessboard, columns x rows."""
    square_mm: Annotated[float, Field(gt=0, le=100)] = 25.0
    stereo_views: Annotated[int, Field(ge=8, le=100)] = 24
    base_frame_joints_deg: JointsDeg
    """Main robot, middle of both arcs: station empty, targets seen by the large-field head."""
    flange_T_target_board: WrittenPose
    """Where the target board lies under a head, roughly: it looks the same upside down."""
    circle_stops: Annotated[int, Field(ge=5, le=60)] = 15
    circle_arc_deg: Annotated[float, Field(ge=20, le=180)] = 100.0
    tracker_frames: Annotated[int, Field(ge=1, le=200)] = 20
    payload_poses: Annotated[int, Field(ge=8, le=60)] = 17
    payload_cone_deg: Annotated[float, Field(ge=3, le=30)] = 12.0
    validity_days: Annotated[int, Field(ge=1, le=3650)] = 180


class CellConfig(Section):
    """Everything the daemon needs to know about one cell."""

    name: Annotated[str, Field(min_length=1, max_length=64)]
    data_dir: str = "runs"
    """Run store and artefacts, relative to the working directory of the daemon."""
    calibration_dir: str = "calibration"
    """Relative to the cell file."""
    plc: Plc = Plc()
    local_api: LocalApi = LocalApi()
    robots: Robots
    heads: Heads
    tracker: Device
    force: Force
    procedures: Procedures
    recipes: Annotated[tuple[Recipe, ...], Field(min_length=1)]

    def devices(self) -> dict[str, Device]:
        """Every device by its path in the file."""
        return {
            "robots.main": self.robots.main,
            "robots.aux_1": self.robots.aux_1,
            "robots.aux_2": self.robots.aux_2,
            "heads.head_1": self.heads.head_1,
            "heads.head_2": self.heads.head_2,
            "tracker": self.tracker,
            "force.sensor": self.force.sensor,
            "force.stop_channel": self.force.stop_channel,
        }

    @property
    def simulated(self) -> bool:
        """True when the devices are fakes."""
        return self.robots.main.simulated

    def recipe(self, recipe_id: int) -> Recipe | None:
        """The recipe with this number."""
        return next((recipe for recipe in self.recipes if recipe.id == recipe_id), None)

    @model_validator(mode="after")
    def _recipe_ids_are_unique(self) -> "CellConfig":
        ids = [recipe.id for recipe in self.recipes]
        if len(set(ids)) != len(ids):
            raise ValueError(f"recipe ids must differ, got {ids}")
        return self
