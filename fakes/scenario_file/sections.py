"""Sections of a scenario file: the devices of a fake cell and every figure of them.

Lengths are in mm, angles in degrees, times in ms, forces in N. A ``*_spread`` is the half width of
a uniform draw, a ``*_sigma`` the standard deviation of a normal draw; ``fakes.world.truth`` makes
the draws.
"""

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, model_validator

Pose = tuple[float, float, float, float, float, float]
"""x, y, z in mm and A, B, C in degrees with R = Rz(A) Ry(B) Rx(C)."""
DeviceName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,31}$")]
Channel = Literal["CMD", "STA", "GRD", "RPC", "FRAMES"]
JobController = Literal["protocol", "jobs"]
"""A job controller speaks SJL from the text of the protocol, or runs the shipped job files."""
Controller = JobController | Literal["rpc"]
"""The last is that of a collaborative arm, which listens."""
Six = tuple[float, float, float, float, float, float]
Three = tuple[float, float, float]
Pair = tuple[float, float]


class Section(BaseModel):
    """A part of the scenario file: no unknown keys, no changes afterwards."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Chain(Section):
    """Nominal links of a 6R arm with a spherical wrist. Stand-ins, not SIASUN data."""

    d1: float
    a1: float
    a2: float
    elbow: float
    d4: float
    d6: float


class Spread(Section):
    """Uniform half widths of a displaced body: along x, y, z and about x, y, z."""

    xyz_mm: Three
    rotation_deg: Three


class Contact(Section):
    """An output of a digital I/O, whose contact is wired to something else."""

    device: DeviceName
    output: int
    """Its address there."""


class Load(Section):
    """What hangs on a flange."""

    mass_kg: float = Field(ge=0, le=35)
    com_mm: Three
    """Centre of mass in the flange."""


class Robot(Section):
    """An arm and its controller."""

    name: str
    """Name by which the controller calls itself on the wire."""
    ports: dict[Channel, int]
    """Ports of the PC that a job controller connects to: CMD, STA and, of an arm that the guard can
    stop, GRD. Or those where a collaborative arm listens: RPC and FRAMES."""
    chain_mm: Chain
    limits_deg: tuple[Pair, Pair, Pair, Pair, Pair, Pair]
    rated_deg_s: Six
    base_mm_deg: Pose
    """Pose of the base in the frame of the cell."""
    base_placement: Spread
    link_sigma_mm: float
    link_sigma_deg: float
    joint_sigma_deg: float
    repeatability_mm: float
    """Three standard deviations of each coordinate."""
    repeatability_deg: float
    correlation_mm: float
    """Travel after which the repeatability error is mostly a new one."""
    settling_mm: float
    """Standard deviation of what every single motion adds, however short it is."""
    settling_deg: float
    start_latency_ms: float
    stop_latency_ms: float
    stop_deceleration_mm_s2: float
    ramp_s: float
    """Time to the rated speed of a joint."""
    speed_max_mm_s: float
    step_max_mm: float
    deadman_ms: int
    streams: bool = False
    """Whether its job program offers streamed motion."""
    stream_travel_mm: float = 30.0
    """Farthest that a stream may go from where it began."""
    stream_travel_deg: float = 5.0
    stream_loss_ms: float = 200.0
    """Time without a setpoint after which it ends a stream."""
    home_deg: Six
    """Joint angles at switch-on."""
    controller: Controller = "protocol"
    statement_ms: float = 0.5
    """Time for a statement of a job file; the speed of the real interpreter is not published."""
    selected_load: Load | None = None
    """Chosen at the pendant of a collaborative arm, whose controller tells it."""
    permit: Contact | None = None
    """The PC's own contact in the permit loop of the controller; without one it is bridged."""

    @model_validator(mode="after")
    def _ports_fit(self) -> Self:
        needed, allowed = (
            ({"RPC", "FRAMES"},) * 2
            if self.controller == "rpc"
            else ({"CMD", "STA"}, {"CMD", "STA", "GRD"})
        )
        if not needed <= self.ports.keys() <= allowed:
            raise ValueError(f"ports of a {self.controller} controller: {sorted(allowed)}")
        return self


class ForceSensor(Section):
    """Six-axis sensor between the flange of a robot and what it carries."""

    port: int
    mounted_on: DeviceName
    flange_T_sensor_mm_deg: Pose
    mounting_sigma_deg: float
    range_n: float
    range_nm: float
    noise_n: float
    noise_nm: float
    vibration_n: float
    vibration_hz: float
    gain_sigma: float
    crosstalk_sigma: float
    offset_sigma_n: float
    offset_sigma_nm: float
    drift_n_per_min: float
    drift_nm_per_min: float


class Springs(Section):
    """How what hangs behind a force sensor is suspended: robot and gripper in series."""

    inertia_kg_m2: Three
    """Moments of inertia about the centre of mass of everything that hangs there."""
    stiffness_n_m: Three
    """Stiffness along the tool's axes, which are those of the flange, turned by 180° about x."""
    rotational_stiffness_nm_rad: Three
    damping_ratio: float


class ChessboardPrint(Section):
    """A printed chessboard, not quite flat."""

    inner_corners: tuple[int, int]
    """Along x, along y."""
    square_mm: float
    size_mm: Pair
    """Size of the plate that carries the print."""
    bow_spread_mm: float
    """Height of its middle over its edges, along each side."""


class StereoRig(Section):
    """How the two cameras of a stereo head stand to each other."""

    baseline_mm: float
    baseline_spread_mm: float
    toe_in_deg: float
    alignment_spread_deg: float


class Optics(Section):
    """Nominal lens and sensor of a make of camera; every camera of it is drawn from here."""

    image_px: tuple[int, int]
    focal_px: float
    focal_spread_px: float
    centre_px: Pair
    centre_spread_px: float
    distortion: tuple[float, float, float, float, float]
    distortion_spread: tuple[float, float, float, float, float]
    blur_px: float
    blur_spread_px: float
    gain_spread: float
    exposure_us: int
    stereo: StereoRig | None = None
    """Arrangement of both cameras; only stereo heads have one."""


class Camera(Section):
    """A camera, carried by a robot or fixed in the cell."""

    serial: str
    port: int
    optics: str
    """Which of the ``[optics.NAME]`` it has."""
    carried_by: DeviceName | None = None
    flange_T_camera_mm_deg: Pose | None = None
    """Nominal pose on the flange of the robot that carries it."""
    cell_T_camera_mm_deg: Pose | None = None
    """Nominal pose in the cell, where nothing carries it."""
    mounting: Spread

    @model_validator(mode="after")
    def _pose_fits_its_place(self) -> Self:
        fixed = self.carried_by is None
        if (self.flange_T_camera_mm_deg is None) is not fixed:
            raise ValueError("a camera with carried_by needs flange_T_camera_mm_deg, no other does")
        if (self.cell_T_camera_mm_deg is None) is fixed:
            raise ValueError("a camera needs either carried_by or cell_T_camera_mm_deg")
        return self


class StereoCamera(Camera):
    """A stereo head; its frame is that of its left camera.

    Its serial number is that of both cameras, left and right, with a plus between them: a PC that
    reads each of them by itself puts them together so, and that of a frame server does likewise.
    """

    @property
    def serials(self) -> tuple[str, str]:
        """Serial numbers of the left and right camera; one number for both gets an L and an R."""
        left, plus, right = self.serial.partition("+")
        return (left, right) if plus else (f"{left}L", f"{left}R")


class RingLamp(Section):
    """The lamp round the lens of a camera, or beside it."""

    brightness: float = Field(default=1.0, gt=0)
    """Brightness of every picture, exposure time included; the rendering is made for 1."""
    polar_deg: float = Field(default=60.0, gt=0, lt=90)
    """Angle of its rays to the line of sight; only connectors show where light comes from."""
    one_sided: float = Field(default=0.0, ge=0, le=1)
    """Share by which the ring is brighter on one side, and darker on the other."""
    azimuth_deg: float = 0.0
    """Where the bright side is, from the image's x towards its y."""
    arc_deg: float | None = Field(default=None, gt=0, le=360)
    """Length of the lit arc; None for the whole ring, about 40 for a lamp at one side."""


class SingleCamera(Camera):
    """A camera with one lens."""

    colour: bool = False
    """Three channels (RGB8) in place of grey levels."""
    lamp: RingLamp = RingLamp()


class Gripper(Section):
    """A pneumatic gripper whose valve and sensors are wired to a Modbus coupler of its own."""

    port: int
    travel_ms: float
    """Time that the jaws travel from one end position to the other."""
    part_present: bool
    """Whether there is a part between the jaws at switch-on."""
    watchdog_ms: int


class DigitalIo(Section):
    """A Modbus coupler with digital inputs and outputs, by their addresses."""

    port: int
    inputs_on: tuple[int, ...] = ()
    """Inputs that are on at switch-on."""
    inputs_off: tuple[int, ...] = ()
    """Inputs that are off at switch-on."""
    outputs: tuple[int, ...] = ()
    watchdog_ms: int


class Tracker(Section):
    """Head that measures targets, fixed above the cell."""

    serial: str
    port: int
    cell_T_tracker_mm_deg: Pose
    placement: Spread
    noise_mm: float
    target_sigma_mm: float
    """Mounting error of each target, constant."""
    targets_on: DeviceName
    """The robot that carries a ring of six targets on its flange."""
    flange_ring_mm: float
    range_mm: Pair
    half_angle_deg: float
    tilt_max_deg: float
    frame_time_ms: float
