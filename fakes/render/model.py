"""Inputs that only tests and offline tools use, beside those of ``fakes.world.scene``."""

from dataclasses import dataclass

from scipy.spatial.transform import RigidTransform

from fakes.world.connector.scene import SceneConnector, SceneMarks
from fakes.world.scene import Body, CameraScene, ScenePlate


@dataclass(frozen=True, slots=True)
class SceneCharucoBoard:
    """ChArUco board; origin in the middle of the printed field, z towards the camera.

    Ids and layout are those of ``cv2.aruco.CharucoBoard(squares, square_m, marker_m, …)`` seen
    from its front, with its x along x and its y along −y of this board.
    """

    camera_T_board: RigidTransform
    squares: tuple[int, int]
    """Along x, along y."""
    square_m: float
    marker_m: float
    dictionary: int
    """A ``cv2.aruco.DICT_…`` number."""
    size_m: tuple[float, float]
    bow_m: tuple[float, float] = (0.0, 0.0)


SceneObject = Body | SceneCharucoBoard


def plain_bodies(scene: CameraScene) -> tuple[Body, ...]:
    """What is neither a connector nor a gripper's marks, which have a renderer of their own."""
    return tuple(body for body in scene.bodies if not isinstance(body, SceneConnector | SceneMarks))


def pose_of(item: SceneObject) -> RigidTransform:
    """Pose of an object in the frame of the camera."""
    return item.camera_T_part if isinstance(item, ScenePlate) else item.camera_T_board
