"""What the cameras saw, and where the flange was."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """One picture: the robot's report and the time of it."""

    base_T_flange: RigidTransform
    joints_rad: Array
    """Shape (6,), as the controller reports them."""
    time_s: float
    camera_id: str
    """Identity of the intrinsics that the picture was measured with."""


@dataclass(frozen=True, slots=True, eq=False)
class PlugLook(Look):
    """Camera II on the plug in the gripper."""

    camera_T_plug: UncertainPose
    camera_T_marks: UncertainPose | None
    """Gripper marks in the same picture; None when they were not measured."""
    connector: str
    """Name of the connector's drawing."""


@dataclass(frozen=True, slots=True, eq=False)
class SocketLook(Look):
    """Camera I on the socket."""

    camera_T_socket: UncertainPose
    connector: str


@dataclass(frozen=True, slots=True, eq=False)
class PlateLook:
    """Both cameras on the plate beside camera II."""

    by_flange_camera: Look
    """Where the flange was when camera I looked."""
    cam1_T_plate: UncertainPose
    cam2_T_plate: UncertainPose
    fixed_camera_id: str


@dataclass(frozen=True, slots=True, eq=False)
class Looks:
    """All looks of one plugging."""

    plug: PlugLook
    sockets: tuple[SocketLook, ...]
    """One or more, each after an approach of its own."""
    plate: PlateLook | None = None

    def all(self) -> tuple[Look, ...]:
        """Every look that was taken with the robot at a place of its own."""
        plate = () if self.plate is None else (self.plate.by_flange_camera,)
        return (self.plug, *self.sockets, *plate)

    @property
    def camera_1_ids(self) -> set[str]:
        """Intrinsics that pictures of camera I were measured with."""
        plate = set() if self.plate is None else {self.plate.by_flange_camera.camera_id}
        return {look.camera_id for look in self.sockets} | plate

    @property
    def camera_2_ids(self) -> set[str]:
        """Intrinsics that pictures of camera II were measured with."""
        plate = set() if self.plate is None else {self.plate.fixed_camera_id}
        return {self.plug.camera_id} | plate
