"""What each head sees from the pose at which it measures, as far as it is in focus."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import trimesh

from cellctl.geometry.pose import Array
from cellctl.planning.scene.cell_scene import CellScene
from cellctl.planning.scene.head_limits import HeadLimits
from cellctl.planning.views.plan_viewpoints import stated_measurements
from cellctl.vision.camera.lens import undistort
from cellctl.vision.camera.stereo_head import CameraModel, StereoHead


@dataclass(frozen=True, slots=True, eq=False)
class Frustum:
    """The space that one camera of a head sees sharply."""

    name: str
    corners_m: Array
    """In the frame of the cell, shape (8, 3): the four of the near end, then those of the far end,
    each in the order of the image's corners round its edge."""

    @property
    def edges_m(self) -> Array:
        """Its twelve edges, shape (12, 2, 3)."""
        around = [(index, (index + 1) % 4) for index in range(4)]
        far = [(first + 4, second + 4) for first, second in around]
        along = [(index, index + 4) for index in range(4)]
        return self.corners_m[[*around, *far, *along]]

    def mesh(self) -> trimesh.Trimesh:
        """Its surface."""
        return trimesh.convex.convex_hull(self.corners_m)


def frusta(scene: CellScene) -> Iterator[Frustum]:
    """Of both cameras of each head that the model describes and a process measures with.

    Raises ``HeadNotDescribed`` where a head is not calibrated or not mounted.
    """
    for measurement in stated_measurements(scene):
        for head in measurement.heads:
            if head.name not in scene.heads or head.robot not in scene.arms:
                continue
            arm = scene.arms[head.robot]
            base_T_flange = arm.base_T_flange(arm.taught_rad(head.pose))
            cell_T_left = arm.cell_T_base * base_T_flange * head.flange_T_camera
            limits, camera = scene.heads[head.name], head.camera
            left_m = _corners_m(camera, camera.left, limits)
            right_m = _corners_m(camera, camera.right, limits)
            name = f"{head.name} at {head.pose}"
            yield Frustum(f"{name}, left", cell_T_left.apply(left_m))
            yield Frustum(
                f"{name}, right", (cell_T_left * camera.right_T_left.inv()).apply(right_m)
            )


def _corners_m(head: StereoHead, camera: CameraModel, limits: HeadLimits) -> Array:
    """Corners of the view in the frame of the camera, shape (8, 3)."""
    width, height = head.image_size
    edge_px = np.array([[0, 0], [width, 0], [width, height], [0, height]], dtype=float)
    rays = np.c_[undistort(camera, edge_px), np.ones(4)]
    return np.vstack([limits.nearest_m * rays, limits.farthest_m * rays])
