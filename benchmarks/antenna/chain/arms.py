"""Arms of several grades: the controller's kinematics, the true ones, and how they warm up."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array
from fakes.scenario_file.sections import Chain
from fakes.world.arm import Links, forward, inverse, nominal_links, perturbed_links
from fakes.world.flaws.transmission import Transmission

CHAIN = Chain(d1=400.0, a1=0.0, a2=440.0, elbow=40.0, d4=440.0, d6=80.0)
"""Reach 0.9 m."""
READY_RAD = np.radians([0.0, -48.0, 100.0, 0.0, 38.0, 0.0])
"""The way the arm is folded, in all poses."""
EXPANSION_PER_K = 20e-6
JOINT_DRIFT_RAD_PER_K = 2e-6


@dataclass(frozen=True, slots=True)
class Grade:
    """How exactly an arm is built or calibrated: standard deviations of every link and joint."""

    name: str
    link_m: float
    link_rad: float
    joint_rad: float
    absolute_error_m: float
    """Mean over the working volume, at the connector."""
    ripple_rad: float = 0.0
    """Amplitude by which the gears of every joint are off, periodic in the joint's angle."""


def _grade(name: str, absolute_error_m: float) -> Grade:
    scale = absolute_error_m / 0.42e-3
    # With 0.1 mm and 0.1 mrad in every link and joint this arm is 0.42 mm off on average.
    return Grade(name, 1e-4 * scale, 1e-4 * scale, 1e-4 * scale, absolute_error_m)


UNCALIBRATED = _grade("uncalibrated", 0.82e-3)
FACTORY = _grade("factory", 0.26e-3)
GEAR_MESH = replace(FACTORY, name="factory, gear mesh", ripple_rad=float(np.radians(5.0 / 3600.0)))
"""The factory's arm with 5 arcsec in every joint: about 20 µm at the connector, over degrees."""
TRACKER = _grade("tracker-calibrated", 0.105e-3)
IDEAL = _grade("ideal kinematics", 0.0)


@dataclass(frozen=True, slots=True)
class Repeatability:
    """How well an arm repeats one approach, as standard deviations per axis."""

    name: str
    position_m: float
    rotation_rad: float


def _repeatability(rp_mm: float, rotation_deg: float) -> Repeatability:
    # ISO 9283: RP is mean plus three standard deviations of the radius, 3.616 per axis.
    return Repeatability(f"RP {rp_mm:g}", rp_mm * 1e-3 / 3.616, float(np.radians(rotation_deg)))


RP_002 = _repeatability(0.02, 0.001)
RP_005 = _repeatability(0.05, 0.0025)


@dataclass(frozen=True, slots=True, eq=False)
class DrawnArm:
    """One arm."""

    links: Links
    repeatability: Repeatability
    transmission: Transmission
    nominal: Links = field(default_factory=lambda: nominal_links(CHAIN))

    @classmethod
    def draw(
        cls, rng: np.random.Generator, grade: Grade, repeatability: Repeatability
    ) -> "DrawnArm":
        """An arm of this grade."""
        links = perturbed_links(CHAIN, rng, grade.link_m, grade.link_rad, grade.joint_rad)
        # Gears of their own chance: arms of one seed differ in nothing else.
        (chance,) = rng.spawn(1)
        gears = Transmission(chance, CHAIN, ripple_rad=grade.ripple_rad, sag_rad=0.0)
        return cls(links, repeatability, gears)

    def joints(self, base_T_flange: RigidTransform) -> Array:
        """What the controller drives to for a commanded pose, rad."""
        return inverse(CHAIN, base_T_flange, READY_RAD)

    def mean_place(self, base_T_flange: RigidTransform) -> RigidTransform:
        """Where the flange stands on average when this pose was commanded."""
        return self._reached(self.joints(base_T_flange))

    def place(self, base_T_flange: RigidTransform, rng: np.random.Generator) -> RigidTransform:
        """Where one approach of a commanded pose ends."""
        return self._scattered(self.mean_place(base_T_flange), rng)

    def turned(
        self, base_T_flange: RigidTransform, angle_rad: float, rng: np.random.Generator
    ) -> RigidTransform:
        """Where the flange ends when the last joint alone has turned on from a commanded pose."""
        joints = self.joints(base_T_flange)
        joints[5] += angle_rad
        return self._scattered(self._reached(joints), rng)

    def reported(self, place: RigidTransform, rng: np.random.Generator) -> RigidTransform:
        """The pose that the controller reports while the flange is held at a place."""
        target = self._scattered(place, rng)
        commanded = target
        # The errors are small and change slowly, so three rounds leave nothing.
        for _ in range(3):
            commanded = commanded * self.mean_place(commanded).inv() * target
        return commanded

    def _reached(self, joints_rad: Array) -> RigidTransform:
        return forward(self.links, joints_rad + self.transmission.error(joints_rad))

    def _scattered(self, pose: RigidTransform, rng: np.random.Generator) -> RigidTransform:
        noise = self.repeatability
        turn = Rotation.from_rotvec(rng.normal(0, noise.rotation_rad, 3))
        return RigidTransform.from_components(
            pose.translation + rng.normal(0, noise.position_m, 3), turn * pose.rotation
        )

    def warmed(self, rng: np.random.Generator, kelvin: float) -> "DrawnArm":
        """The arm after its links and joints have warmed up, each by itself."""
        matrices = self.links.matrices.copy()
        # All links but the base grow along their length, each by its own temperature.
        growth = 1 + EXPANSION_PER_K * rng.normal(0, kelvin, len(matrices))
        matrices[1:, :3, 3] *= growth[1:, None]
        offsets = self.links.joint_offsets_rad + JOINT_DRIFT_RAD_PER_K * rng.normal(0, kelvin, 6)
        return replace(self, links=Links(matrices, offsets))
