"""Sections that name a driver and hand it its own settings."""

from typing import Annotated, Any

from pydantic import Field

from cellctl.config.base import JointsDeg, Section, WrittenPose


class Device(Section):
    """A device: which driver, its settings, and whether it is a fake."""

    driver: str
    simulated: bool = False
    settings: dict[str, Any] = Field(default_factory=dict)
    """Checked by the driver's own ``Config``."""


class MainRobot(Device):
    """The robot that carries the deck."""

    home_joints_deg: JointsDeg
    """Clear of the station and of both heads."""
    deck_measure_joints_deg: JointsDeg
    """Deck above the station, all six holes in view of the heads."""
    speed_percent: Annotated[int, Field(ge=1, le=100)] = 40
    """Of rated joint speed, for moves between taught poses."""
    linear_speed_mm_s: Annotated[float, Field(ge=1, le=500)] = 50.0
    linear_acceleration_mm_s2: Annotated[float, Field(ge=1, le=2000)] = 200.0
    flange_T_sensor: WrittenPose
    """Pose of the force sensor's frame on the flange."""
    d1_mm: Annotated[float, Field(ge=100, le=3000)]
    """D-H: height of the A2 axis above the base plane."""
    a1_mm: Annotated[float, Field(ge=0, le=2000)]
    """D-H: distance of the A2 axis from the A1 axis."""


class AuxiliaryRobot(Device):
    """A robot that carries a stereo head."""

    measuring_joints_deg: JointsDeg
    retracted_joints_deg: JointsDeg
    speed_percent: Annotated[int, Field(ge=1, le=100)] = 40
    linear_speed_mm_s: Annotated[float, Field(ge=1, le=500)] = 100.0
    linear_acceleration_mm_s2: Annotated[float, Field(ge=1, le=2000)] = 400.0
    flange_T_head: WrittenPose
    """Nominal pose of the left camera on the flange, for planning views only."""


class Robots(Section):
    """The three robots of the cell."""

    main: MainRobot
    aux_1: AuxiliaryRobot
    aux_2: AuxiliaryRobot


class Heads(Section):
    """The two small-field stereo heads."""

    head_1: Device
    head_2: Device


class Force(Section):
    """Force sensor, the guard's line to the main robot, and the guard."""

    sensor: Device
    stop_channel: Device
    stale_ms: Annotated[float, Field(ge=2, le=500)] = 10.0
    """While armed: no sample for this long is a trip."""
    flange_age_ms: Annotated[float, Field(ge=20, le=1000)] = 100.0
    """While armed: a flange pose older than this is a trip."""
    cpu: Annotated[int, Field(ge=0, le=255)] | None = None
    """Pin the guard to this processor; off by default."""
