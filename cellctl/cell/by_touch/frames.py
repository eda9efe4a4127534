"""Where task, tip and flange stand to each other during a streamed contact."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array


@dataclass(frozen=True, slots=True, eq=False)
class ContactFrames:
    """Poses that stay the same while the stream lasts.

    The tip's pose in the task is written as six numbers: position (m) and the rotation vector (rad)
    that turns the nominal attitude into it, both in the axes of the task.
    """

    base_T_task: RigidTransform
    flange_T_tip: RigidTransform
    task_R_nominal: Rotation
    """Attitude of the tip at which the peg is to go in; any rotation, for instance half a turn."""

    def tip(self, base_T_flange: RigidTransform) -> Array:
        """Six numbers of the tip, shape (6,)."""
        task_T_tip = self.base_T_task.inv() * base_T_flange * self.flange_T_tip
        turned = task_T_tip.rotation * self.task_R_nominal.inv()
        return np.concatenate([task_T_tip.translation, turned.as_rotvec()])

    def base_T_flange(self, tip: Array) -> RigidTransform:
        """The flange for six numbers of the tip, shape (6,)."""
        task_T_tip = RigidTransform.from_components(
            tip[:3], Rotation.from_rotvec(tip[3:]) * self.task_R_nominal
        )
        return self.base_T_task * task_T_tip * self.flange_T_tip.inv()

    def in_task(self, tip: Array, tip_wrench: Array) -> Array:
        """A wrench about the tip, turned from the axes of the tip to those of the task; (6,)."""
        task_R_tip = Rotation.from_rotvec(tip[3:]) * self.task_R_nominal
        return np.concatenate([task_R_tip.apply(tip_wrench[:3]), task_R_tip.apply(tip_wrench[3:])])


def displaced(nominal: Array, displacement: Array) -> Array:
    """Six numbers of the tip after a displacement in the axes of the task; all of shape (6,)."""
    turned = Rotation.from_rotvec(displacement[3:]) * Rotation.from_rotvec(nominal[3:])
    return np.concatenate([nominal[:3] + displacement[:3], turned.as_rotvec()])
