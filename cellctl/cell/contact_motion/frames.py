"""How task, tip and flange stand to each other during a streamed contact."""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.geometry.pose import Array, turn_matrix


class ContactFrames:
    """Poses that stay the same while the stream lasts.

    The tip's pose in the task is written as six numbers: position (m) and the rotation vector (rad)
    that turns the nominal attitude into it, both in the axes of the task.
    """

    def __init__(
        self, base_T_task: RigidTransform, flange_T_tip: RigidTransform, task_R_nominal: Rotation
    ) -> None:
        """``task_R_nominal``: attitude of the tip at which the peg goes in; any rotation."""
        self.base_T_task, self.flange_T_tip = base_T_task, flange_T_tip
        self.task_R_nominal = task_R_nominal
        # Matrices, because every tick of the stream needs them and products of poses take ten
        # times as long.
        self._base_T_task = base_T_task.as_matrix()
        self._task_T_base = base_T_task.inv().as_matrix()
        self._flange_T_tip = flange_T_tip.as_matrix()
        self._tip_T_flange = flange_T_tip.inv().as_matrix()
        self._task_R_nominal = task_R_nominal.as_matrix()

    def tip(self, base_T_flange: RigidTransform) -> Array:
        """Six numbers of the tip, shape (6,)."""
        task_T_tip = self._task_T_base @ base_T_flange.as_matrix() @ self._flange_T_tip
        # Products of few rotations are rotations to the last digits. To make sure of it at every
        # tick, as both constructors do unless told, takes four times as long as all the rest here.
        turned = Rotation.from_matrix(
            task_T_tip[:3, :3] @ self._task_R_nominal.T, assume_valid=True
        )
        return np.concatenate([task_T_tip[:3, 3], turned.as_rotvec()])

    def base_T_flange(self, tip: Array) -> RigidTransform:
        """The flange for six numbers of the tip, shape (6,)."""
        task_T_tip = np.eye(4)
        task_T_tip[:3, :3] = self._task_R_tip(tip)
        task_T_tip[:3, 3] = tip[:3]
        base_T_flange = self._base_T_task @ task_T_tip @ self._tip_T_flange
        return RigidTransform(base_T_flange, normalize=False, copy=False)

    def in_task(self, tip: Array, tip_wrench: Array) -> Array:
        """A wrench about the tip, turned from the axes of the tip to those of the task; (6,)."""
        return np.ravel(tip_wrench.reshape(2, 3) @ self._task_R_tip(tip).T)

    def _task_R_tip(self, tip: Array) -> Array:
        return turn_matrix(tip[3:]) @ self._task_R_nominal


def displaced(nominal: Array, displacement: Array) -> Array:
    """Six numbers of the tip after a displacement in the axes of the task; all of shape (6,)."""
    turned = Rotation.from_rotvec(displacement[3:]) * Rotation.from_rotvec(nominal[3:])
    return np.concatenate([nominal[:3] + displacement[:3], turned.as_rotvec()])
