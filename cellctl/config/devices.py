"""Sections of the cell file that describe its devices: any number of each kind, each with a name.

The name of a device is its table's name: ``[robots.main]`` is the robot ``main``. A process asks
for its devices by such names (``cellctl.config.roles``).
"""

from typing import Annotated, Any, Self

from pydantic import Field, StringConstraints, field_validator, model_validator

from cellctl import plugins
from cellctl.config.base import JointsDeg, LessSafe, Section, WrittenPose

ComMm = Annotated[float, Field(ge=-3000, le=3000)]
Pixels = Annotated[float, Field(gt=0, le=5000)]
Milliseconds = Annotated[float, Field(gt=0, le=60_000)]
DeviceName = Annotated[
    str,
    StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,31}$"),
    Field(examples=["head_1"]),
]


class DeviceConfig(Section):
    """A device: which driver, its settings, and whether it is a fake."""

    driver: str
    """Name of an installed driver of its kind."""
    simulated: bool = False
    """True for a fake. The devices of a cell are all fakes, or none is."""
    serial_number: Annotated[str, Field(max_length=100)] = ""
    """Serial number on its type plate, for the record of a run."""
    certificate: Annotated[str, Field(max_length=200)] = ""
    """Number and date of the certificate of its calibration, for the record of a run; a force
    sensor without one leaves the figures of force untraced."""
    settings: dict[str, Any] = Field(default_factory=dict)
    """Settings, which the driver's own ``Config`` checks."""


class PermitConfig(Section):
    """A digital output of this PC whose contact is in the permit loop of a robot."""

    device: DeviceName
    """The digital I/O; one with a watchdog, so that the contact opens when this PC dies."""
    output: str
    """Name of the output there; on is the permit."""


class LightConfig(Section):
    """A lamp at a digital output, which is on while an image is exposed."""

    device: DeviceName
    """The digital I/O; one with a watchdog switches the lamp off when this PC dies."""
    output: str
    """Name of the output there; on is light."""
    settle_s: Annotated[float, Field(ge=0, le=10)] = 0.0
    """Time from the confirmed output to the exposure, in which the lamp reaches its full light."""


class AutoExposureConfig(Section):
    """How the exposure of a camera is found: by the surface round dark holes."""

    hole_px: tuple[Pixels, Pixels]
    """Least and greatest radius of the holes in the image."""
    target_grey: Annotated[float, Field(ge=20, le=240)] = 180.0
    """Grey that the surface round the holes shall have, of 255."""
    exposure_ms: tuple[Milliseconds, Milliseconds] = (0.02, 200.0)
    """Least and greatest exposure."""
    tries: Annotated[int, Field(ge=1, le=100)] = 16
    """Exposures until it is given up."""
    within_s: Annotated[float, Field(gt=0, le=600)] = 60.0
    """Time until it is given up."""

    @field_validator("hole_px", "exposure_ms")
    @classmethod
    def _least_first(cls, limits: tuple[float, float]) -> tuple[float, float]:
        if limits[0] >= limits[1]:
            raise ValueError("the least first, then the greatest")
        return limits


class WayConfig(Section):
    """A way between two taught poses, for where the straight one is not free."""

    start: DeviceName
    """Taught pose from which it leads."""
    end: DeviceName
    """Taught pose to which it leads; back, it needs a way of its own."""
    via_deg: Annotated[tuple[JointsDeg, ...], Field(min_length=1, max_length=20)]
    """Joints at which the arm stops on its way; between them it goes straight in the joints."""


class MaintenanceSpeeds(Section):
    """What no move of a robot exceeds while the unit is in Maintenance."""

    speed_percent: Annotated[int, Field(ge=1, le=100)]
    """Speed of moves between taught poses, as a share of rated joint speed."""
    linear_speed_mm_s: Annotated[float, Field(ge=10, le=500)]
    """Speed of straight moves. At least 10: a procedure that measures how an arm stops moves it at
    up to 8 mm/s, and would take a slower move for a quicker stop."""


class LoadConfig(Section):
    """Everything that hangs on the flange, force sensor and gripped part included.

    A person selects it on the controller; with a wrong one the arm sags and overshoots."""

    mass_kg: Annotated[float, Field(gt=0, le=2000)]
    """Its mass, as selected on the controller."""
    com_mm: tuple[ComMm, ComMm, ComMm]
    """Its centre of mass in the flange."""
    tolerance_kg: Annotated[float, Field(gt=0, le=200)]
    """Largest difference of the controller's mass, or of the weighed one, from ``mass_kg``."""
    tolerance_mm: Annotated[float, Field(gt=0, le=500)]
    """The same for each coordinate of the centre of mass."""
    not_weighed_kg: Annotated[float, Field(ge=0, le=200)] = 0.0
    """Share that the force sensor does not feel: its own body and what is between it and the
    flange. Its centre of mass is taken at the sensor's frame."""

    @model_validator(mode="after")
    def _something_is_weighed(self) -> Self:
        if self.not_weighed_kg >= self.mass_kg:
            raise ValueError("not_weighed_kg must be less than mass_kg")
        return self


class RobotConfig(DeviceConfig):
    """A robot, with the poses that were taught and the speeds between them."""

    poses_deg: dict[DeviceName, JointsDeg] = Field(default_factory=dict)
    """Taught joint positions by name, such as ``home``; a process says which ones it needs."""
    ways: tuple[WayConfig, ...] = ()
    """Ways between taught poses by joints; where none is stated, such a move goes straight."""
    permit: PermitConfig | None = None
    """Contact that opens with every stop and closes when the robot is re-armed."""
    load: LoadConfig | None = None
    """Load that the weighed one, and that of a controller that tells it, are compared with."""
    speed_percent: Annotated[int, Field(ge=1, le=100)] = 40
    """Speed of moves between taught poses, as a share of rated joint speed."""
    linear_speed_mm_s: Annotated[float, Field(ge=1, le=500)] = 50.0
    """Speed of straight moves that touch nothing."""
    linear_acceleration_mm_s2: Annotated[float, Field(ge=1, le=2000)] = 200.0
    """Their acceleration, and how they brake."""
    in_maintenance: MaintenanceSpeeds | None = None
    """Lower speeds for the mode in which people set up the cell; none: those above."""
    d1_mm: Annotated[float, Field(ge=100, le=3000)] | None = None
    """D-H: height of the A2 axis above the base plane; the base frame's calibration needs it. Where
    it is not stated the ``dh`` table of the driver's settings gives it."""
    a1_mm: Annotated[float, Field(ge=0, le=2000)] | None = None
    """D-H: distance of the A2 axis from the A1 axis, likewise."""


class CameraConfig(DeviceConfig):
    """A single camera, carried by a robot or fixed in the cell."""

    carried_by: DeviceName | None = None
    """The robot that carries it; none where it is fixed."""
    flange_T_camera: WrittenPose | None = None
    """Nominal pose on the flange of the robot that carries it, for planning views only."""
    light: LightConfig | None = None
    """Lamp that is switched on for each exposure; cameras may share one."""
    auto_exposure: AutoExposureConfig | None = None
    """How the exposure of a run is found, before its first measurement; without this it is that of
    the settings, or of the camera."""


class StereoCameraConfig(CameraConfig):
    """A stereo head; ``flange_T_camera`` is the pose of its left camera."""


class TrackerConfig(DeviceConfig):
    """A large-field head that measures targets."""


class GripperConfig(DeviceConfig):
    """A gripper."""


class DigitalIoConfig(DeviceConfig):
    """Digital inputs and outputs."""


class ForceSensorConfig(DeviceConfig):
    """A force sensor with its guard: a process of its own that stops the robot it is mounted on."""

    mounted_on: DeviceName
    """The robot whose moves the guard watches and stops."""
    flange_T_sensor: WrittenPose
    """Pose of the sensor's frame on the flange of that robot."""
    stop_channel: DeviceConfig
    """The guard's own line to that robot."""
    stale_ms: Annotated[float, Field(ge=2, le=500), LessSafe.WITH_MORE] = 10.0
    """Time without a sample that is a trip while the guard is armed."""
    flange_age_ms: Annotated[float, Field(ge=20, le=1000), LessSafe.WITH_MORE] = 100.0
    """Age of the flange pose that is a trip while the guard is armed."""
    free_force_n: Annotated[float, Field(gt=0, le=20_000), LessSafe.WITH_MORE] = 2000.0
    """Greatest force at the sensor in moves that should touch nothing: what the load makes of their
    acceleration and, before it was identified, of their tilt. The default fits 200 kg at 40 % of
    rated joint speed: 1.5 kN on the fake cell."""
    free_moment_n_m: Annotated[float, Field(gt=0, le=20_000), LessSafe.WITH_MORE] = 900.0
    """The same for moments: 0.6 kN·m on the fake cell."""
    cpu: Annotated[int, Field(ge=0, le=255)] | None = None
    """Pin the guard to this processor; off by default."""


GROUPS = {
    "robots": plugins.ROBOT,
    "stereo_cameras": plugins.STEREO_CAMERA,
    "cameras": plugins.CAMERA,
    "trackers": plugins.TARGET_TRACKER,
    "force_sensors": plugins.FT_SENSOR,
    "grippers": plugins.GRIPPER,
    "digital_ios": plugins.DIGITAL_IO,
}
"""Entry-point group of the drivers of each section of the cell file."""
