"""A sensor with a load, for tests: truth that identification has to find."""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.force.gravity.payload import Rigid12
from cellctl.force.gravity.pose_file import QUATERNION, ROLE, WRENCH, PoseRecord
from cellctl.force.gravity.poses import IdentificationPose, plan_identification
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import skew

MATING = RigidTransform.from_components(
    [1.9, 0.0, 0.917], Rotation.from_euler("ZYX", [90.0, 0.0, 180.0], degrees=True)
)
PIVOT = np.array([0.0, 0.0, 0.5])


@dataclass
class LoadedSensor:
    """Readings of a still load; ``matrix`` is what an imperfect sensor makes of them."""

    mass_kg: float = 200.0
    centre_m: Array = field(default_factory=lambda: np.array([0.03, 0.02, 0.4]))
    offset: Array = field(default_factory=lambda: np.array([40.0, -25.0, 60.0, 5.0, -3.0, 2.0]))
    matrix: Array = field(default_factory=lambda: np.eye(6))
    base_tilt: Rotation = field(default_factory=Rotation.identity)
    mounting: Rotation = field(default_factory=Rotation.identity)
    noise: Array = field(default_factory=lambda: np.zeros(6))

    def read(self, base_R_sensor: Rotation, rng: np.random.Generator) -> Array:
        """Shape (n, 6)."""
        weight = self.base_tilt.apply([0.0, 0.0, -9.80665 * self.mass_kg])
        force = (base_R_sensor * self.mounting).inv().apply(weight)
        load = np.hstack([force, np.cross(self.centre_m, force)])
        return load @ self.matrix.T + self.offset + rng.normal(size=load.shape) * self.noise


def imperfect(rng: np.random.Generator) -> LoadedSensor:
    """Cross-talk of 1 %, gain 0.3 %, mounting 0.3°: the sources of force.md table 2.4."""
    ranges = np.repeat([5000.0, 1000.0], 3)
    crosstalk = rng.normal(0.0, 0.01, (6, 6)) * np.outer(ranges, 1.0 / ranges)
    np.fill_diagonal(crosstalk, rng.normal(0.0, 0.003, 6))
    return LoadedSensor(
        matrix=np.eye(6) + crosstalk,
        mounting=Rotation.from_rotvec(rng.normal(0.0, np.deg2rad(0.3), 3)),
        base_tilt=Rotation.from_rotvec([*rng.normal(0.0, np.deg2rad(0.2), 2), 0.0]),
        noise=np.repeat([0.15, 0.03], 3),
    )


def cone(**settings: float) -> tuple[IdentificationPose, ...]:
    """The plan of the procedure around the mating orientation."""
    half_angle_rad = float(np.deg2rad(settings.get("half_angle_deg", 12.0)))
    return plan_identification(
        MATING,
        pivot_in_flange_m=PIVOT,
        half_angle_rad=half_angle_rad,
        fit_poses=int(settings.get("fit_poses", 12)),
    )


def rotations(poses: tuple[IdentificationPose, ...]) -> Rotation:
    """Stacked base_R_sensor, the sensor being parallel to the flange."""
    return Rotation.concatenate([pose.base_T_flange.rotation for pose in poses])


def record(sensor: LoadedSensor, rng: np.random.Generator) -> PoseRecord:
    """What the procedure records."""
    poses = cone()
    turned = rotations(poses)
    return PoseRecord(turned, sensor.read(turned, rng), tuple(pose.role for pose in poses))


def compensation_of(rigid: Rigid12) -> GravityCompensation:
    """The rigid model in the affine form, to compare both on the same readings."""
    sign = -1.0 if rigid.reads_reaction else 1.0
    force = sign * float(np.linalg.norm(rigid.weight_n)) * np.eye(3)
    return GravityCompensation(
        np.vstack([force, skew(rigid.centre_of_mass_m) @ force]),
        np.concatenate([rigid.force_offset_n, rigid.torque_offset_n_m]),
        "rigid12",
        base_down=rigid.base_down,
    )


def format_pose_file(data: PoseRecord) -> str:
    """The text that ``parse_pose_file`` reads back to the same record."""
    lines = [",".join((*QUATERNION, *WRENCH, ROLE))]
    for quaternion, wrench, role in zip(
        data.base_R_sensor.as_quat(), data.wrenches, data.roles, strict=True
    ):
        numbers = [f"{value:.9f}" for value in quaternion] + [f"{value:.4f}" for value in wrench]
        lines.append(",".join((*numbers, role.value)))
    return "\n".join(lines) + "\n"
