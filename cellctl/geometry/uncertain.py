"""Poses with a covariance, and its propagation along a chain of poses.

Convention for the 6x6 covariance of ``a_T_b``: order x, y, z, rx, ry, rz; the origin of b and a
small rotation vector, both in the axes of a: ``t = t0 + dt``, ``R = Exp(dr) R0``. SI units.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class UncertainPose:
    """A pose and its 6x6 covariance (m², m·rad, rad²) in the convention of this module."""

    pose: RigidTransform
    covariance: Array

    @classmethod
    def exact(cls, pose: RigidTransform) -> "UncertainPose":
        """A pose that is taken as known."""
        return cls(pose, np.zeros((6, 6)))

    def __mul__(self, other: "UncertainPose") -> "UncertainPose":
        """``a_T_c = a_T_b * b_T_c`` with independent errors."""
        from_self, from_other = product_jacobians(self.pose, other.pose)
        covariance = (
            from_self @ self.covariance @ from_self.T + from_other @ other.covariance @ from_other.T
        )
        return UncertainPose(self.pose * other.pose, covariance)

    def inv(self) -> "UncertainPose":
        """``b_T_a`` from ``a_T_b``."""
        jacobian = inverse_jacobian(self.pose)
        return UncertainPose(self.pose.inv(), jacobian @ self.covariance @ jacobian.T)

    @property
    def sigma(self) -> Array:
        """Standard deviations x, y, z (m), rx, ry, rz (rad)."""
        return np.sqrt(np.diag(self.covariance))


def product_jacobians(a_T_b: RigidTransform, b_T_c: RigidTransform) -> tuple[Array, Array]:
    """How small errors of two poses change their product, in the convention of this module.

    Shape (6, 6) each: of ``a_T_b`` and of ``b_T_c``.
    """
    rotation = a_T_b.rotation.as_matrix()
    arm = rotation @ b_T_c.translation
    from_first: Array = np.eye(6)
    # A turn of the first pose by dr moves the origin of c by dr × arm = −arm × dr.
    from_first[:3, 3:] = -skew(arm)
    return from_first, np.asarray(np.kron(np.eye(2), rotation))


def inverse_jacobian(a_T_b: RigidTransform) -> Array:
    """How small errors of a pose change its inverse, shape (6, 6)."""
    rotation_t = a_T_b.rotation.inv().as_matrix()
    jacobian = np.zeros((6, 6))
    jacobian[:3, :3] = -rotation_t
    # t' = −Rᵀ t: a turn of b by dr changes Rᵀ, and with it t', by −Rᵀ (t × dr).
    jacobian[:3, 3:] = -rotation_t @ skew(a_T_b.translation)
    jacobian[3:, 3:] = -rotation_t
    return jacobian


def perturbed(pose: RigidTransform, delta: Array) -> RigidTransform:
    """A pose moved by six small numbers, shape (6,), in the convention of this module."""
    rotation = Rotation.from_rotvec(delta[3:]) * pose.rotation
    return RigidTransform.from_components(pose.translation + delta[:3], rotation)


def skew(vector: Array) -> Array:
    """Matrix of the cross product, shape (3, 3): ``skew(a) @ b == a × b``."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def skews(vectors: Array) -> Array:
    """``skew`` of n vectors, shape (n, 3); shape (n, 3, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
