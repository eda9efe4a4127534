"""A pose whose covariance is kept apart by its causes, so that a plan can say what limits it."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose, inverse_jacobian, product_jacobians


class Term(StrEnum):
    """Causes of a plug's error."""

    LOOK_PLUG = "look_plug"
    LOOK_SOCKET = "look_socket"
    APPROACH = "approach"
    """Repeatability of the robot, once for every approach that enters."""
    CORRECTION = "correction"
    DRIFT = "drift"
    HAND_EYE = "hand_eye"
    KINEMATICS = "kinematics"
    """The robot's absolute error between the places that are compared."""


_NONE = np.zeros((6, 6))


@dataclass(frozen=True, slots=True, eq=False)
class TermedPose:
    """``a_T_b`` with one 6x6 covariance per cause, in the convention of ``geometry.uncertain``.

    Different causes, and one cause in different poses, are independent of each other.
    """

    pose: RigidTransform
    terms: Mapping[Term, Array]

    @classmethod
    def exact(cls, pose: RigidTransform) -> "TermedPose":
        """A pose that is taken as known."""
        return cls(pose, {})

    @classmethod
    def of(cls, term: Term, uncertain: UncertainPose) -> "TermedPose":
        """A pose whose whole covariance has one cause."""
        return cls(uncertain.pose, {term: uncertain.covariance})

    def __mul__(self, other: "TermedPose") -> "TermedPose":
        """``a_T_c = a_T_b * b_T_c``."""
        composed: dict[Term, Array] = {}
        for pose, jacobian in zip(
            (self, other), product_jacobians(self.pose, other.pose), strict=True
        ):
            for term, covariance in pose.terms.items():
                carried = jacobian @ covariance @ jacobian.T
                composed[term] = composed.get(term, _NONE) + carried
        return TermedPose(self.pose * other.pose, composed)

    def inv(self) -> "TermedPose":
        """``b_T_a``."""
        jacobian = inverse_jacobian(self.pose)
        inverted = {term: jacobian @ one @ jacobian.T for term, one in self.terms.items()}
        return TermedPose(self.pose.inv(), inverted)

    @property
    def total(self) -> UncertainPose:
        """The pose with the covariance of all causes."""
        return UncertainPose(self.pose, np.sum([_NONE, *self.terms.values()], axis=0))


def only_plane(seen: UncertainPose) -> UncertainPose:
    """Without the variances of height and tilt, which one image does not measure.

    For what sits fixed on the gripper: its height and tilt before the camera are the same in every
    look, so a taught correction takes them up. As priors they would count as new errors each time.
    """
    kept = np.diag([1.0, 1.0, 0.0, 0.0, 0.0, 1.0])
    return UncertainPose(seen.pose, kept @ seen.covariance @ kept)
