"""The chain of a six-axis arm by its standard (distal) Denavit-Hartenberg table.

Each joint is Rz(theta) Tz(d) Tx(a) Rx(alpha), with theta the joint's angle and a fixed offset
(Denavit and Hartenberg, J. Appl. Mech. 22 (1955) 215; Siciliano et al., Robotics, section 2.8.2).
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class ArmChain:
    """The links of one arm from its base to its flange, and the limits of its joints."""

    dh: Array
    """Shape (6, 4): theta in rad, added to the joint's angle; d in m; a in m; alpha in rad."""
    lower_rad: Array
    """Shape (6,)."""
    upper_rad: Array
    """Shape (6,)."""
    _links: tuple[Array, Array, Array] = field(init=False, repr=False)
    """The pose of each link is the sum of three parts, each of shape (6, 4, 4): one is constant,
    one is multiplied by the cosine of the joint's angle, and one by its sine."""

    def __post_init__(self) -> None:
        _, d_m, a_m, alpha = self.dh.T
        ca, sa = np.cos(alpha), np.sin(alpha)
        constant, cosine, sine = np.zeros((3, 6, 4, 4))
        constant[:, 2, 1], constant[:, 2, 2], constant[:, 2, 3] = sa, ca, d_m
        constant[:, 3, 3] = 1.0
        cosine[:, 0, 0], cosine[:, 0, 3] = 1.0, a_m
        cosine[:, 1, 1], cosine[:, 1, 2] = ca, -sa
        sine[:, 0, 1], sine[:, 0, 2] = -ca, sa
        sine[:, 1, 0], sine[:, 1, 3] = 1.0, a_m
        object.__setattr__(self, "_links", (constant, cosine, sine))

    def link_frames(self, joints_rad: Array) -> Array:
        """``base_T_link`` of base and all six links, shape (7, 4, 4), at joints of shape (6,)."""
        frames = np.empty((7, 4, 4))
        frames[0] = np.eye(4)
        constant, cosine, sine = self._links
        angle = (self.dh[:, 0] + joints_rad)[:, None, None]
        for index, link in enumerate(constant + np.cos(angle) * cosine + np.sin(angle) * sine):
            np.matmul(frames[index], link, out=frames[index + 1])
        return frames

    def base_T_flange(self, joints_rad: Array) -> RigidTransform:
        """Pose of the flange at joints of shape (6,)."""
        # A product of rotations is one: `from_matrix` would look whether it is.
        return RigidTransform(self.link_frames(joints_rad)[6], normalize=False)

    def flange_m(self, joints_rad: Array) -> Array:
        """Place of the flange alone, shape (3,): a transform takes far longer to make."""
        return np.asarray(self.link_frames(joints_rad)[6, :3, 3])

    @property
    def length_m(self) -> float:
        """Length of all links one after another: no flange is farther from its base."""
        return float(np.hypot(self.dh[:, 1], self.dh[:, 2]).sum())


def flange_jacobian(base_T_links: Array) -> Array:
    """Velocity of the flange by those of the joints, in the axes of the base, shape (6, 6).

    ``base_T_links`` has shape (7, 4, 4), as ``ArmChain.link_frames`` gives it. Three rows in m/rad,
    three in rad/rad (Siciliano et al., Robotics, section 3.1.3).
    """
    axes, points = base_T_links[:6, :3, 2], base_T_links[:6, :3, 3]
    x, y, z = (base_T_links[6, :3, 3] - points).T
    ax, ay, az = axes.T
    # Written out, because numpy's cross product takes longer than all the rest.
    return np.array([ay * z - az * y, az * x - ax * z, ax * y - ay * x, ax, ay, az])
