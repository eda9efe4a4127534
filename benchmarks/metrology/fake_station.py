"""The deck's fake cell without wire and without a clock: arms that go where they are told, images.

What the loop sees is what it sees in `cellctl demo`: the same world, renderer and calibrations.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.geometry.units import in_mm_deg
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry, combined
from cellctl.processes.deck_to_frame.poses.pose_correction import Thresholds, target_M_T_D
from cellctl.processes.deck_to_frame.recipe import PoseCorrection
from cellctl.processes.deck_to_frame.run import SHARE_OF_ONE_PART
from cellctl.vision.features.feature_file import FeatureFile
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.registration.part_pose import PartPose
from fakes.render.look import options_of
from fakes.render.worker import render_frame
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.arm import inverse
from fakes.world.frames import from_written
from fakes.world.scene import CameraScene

SCENARIO = Path(__file__).parents[2] / "config" / "deck.scenario.toml"
FRAME_S = 1.137
"""Time from one pair of images to the next, as in the demonstration on a free machine; it is no
multiple of the period with which the arms sway."""
SETTLE_S = 1.5
SPEED_M_S, ACCELERATION_M_S2 = 0.05, 0.2

HEADS = "head_1", "head_2"


@dataclass(frozen=True, slots=True)
class Shot:
    """One pair of images and the scene that they show."""

    scene: CameraScene
    images: tuple[Image, Image]


class FakeStation:
    """One drawn cell with both heads at their measuring poses and the deck clear of the frame."""

    def __init__(self, scenario: DeckScenario, seed: int, geometry: HeadGeometry) -> None:
        self.world = DeckOnFrame(scenario, seed)
        self._geometry = geometry
        assert scenario.rendering is not None  # the scenario's model demands it of cameras
        self.look = options_of(
            scenario.rendering,
            glare=scenario.size_of("glare"),
            tilt_shading=scenario.size_of("tilt_shading"),
        )
        for robot in ("aux_1", "aux_2"):
            self._to_taught(robot, "measure")
        self._to_taught("main", "clear")

    # -- main robot -----------------------------------------------------------------------------
    def to_deck_measure(self) -> None:
        """The main robot holds the deck above the station."""
        self._to_taught("main", "deck_measure")

    def base_T_flange(self) -> RigidTransform:
        """Pose of the main robot's flange, as the robot reports it."""
        return self.world.arms["main"].encoder_pose(self.world.time_s)

    def move_flange(self, base_T_flange: RigidTransform) -> None:
        """Straight, then wait until the deck is still."""
        arm = self.world.arms["main"]
        arm.start_linear(self.world.time_s, base_T_flange, SPEED_M_S, ACCELERATION_M_S2)
        self.world.advance(arm.standstill_s + SETTLE_S)

    def to_stand_off(self, height_m: float) -> None:
        """The deck so high over its frame, as well as the arm knows."""
        parts = self.world.placed.parts
        assert parts is not None
        above = target_M_T_D(0.0, height_m)
        self.move_flange(parts.cell_T_frame * above * parts.flange_T_deck.inv())

    def _to_taught(self, robot: str, name: str) -> None:
        arm = self.world.arms[robot]
        cell_T_base = from_written(arm.settings.base_mm_deg)
        pose = cell_T_base.inv() * from_written(self.world.scenario.taught[robot][name])
        joints = inverse(arm.settings.chain_mm, pose, arm.joints(self.world.time_s))
        arm.start_joint(self.world.time_s, joints, 100)
        self.world.advance(arm.standstill_s + SETTLE_S)

    def true_frame_T_deck(self) -> RigidTransform:
        """The deck's outer face in the frame."""
        parts, cell_T_deck = self.world.placed.parts, self.world.cell_T_deck()
        assert parts is not None
        assert cell_T_deck is not None
        return parts.cell_T_frame.inv() * cell_T_deck

    # -- heads ----------------------------------------------------------------------------------
    def measure(
        self,
        features: FeatureFile,
        c1_T_part: RigidTransform,
        settings: PoseCorrection,
        thresholds: Thresholds,
    ) -> tuple[PartPose, int]:
        """Frames are added as ``PartMeasurer`` adds them; the pose, and how many it took."""
        wanted = thresholds.vector * thresholds.uncertainty_share * SHARE_OF_ONE_PART
        taken: list[tuple[PairMeasurement, PairMeasurement]] = []
        while True:
            for _ in range(min(len(taken) or settings.frames, settings.max_frames - len(taken))):
                taken.append(self._one_frame(features, c1_T_part))
            pose = combined(features, taken, self._geometry, settings.method)[1]
            certain = _sigma_in_part(pose) <= in_mm_deg(wanted)
            if certain.all() or len(taken) >= settings.max_frames:
                return pose, len(taken)

    def _one_frame(
        self, features: FeatureFile, c1_T_part: RigidTransform
    ) -> tuple[PairMeasurement, PairMeasurement]:
        self.wait()
        predictions = self._geometry.camera_T_part(c1_T_part)
        models = self._geometry.head_1, self._geometry.head_2
        holes = features.seen_by(1), features.seen_by(2)
        one, two = (
            measure_pair(*self.shot(head).images, models[i], holes[i], camera_T_part=predictions[i])
            for i, head in enumerate(HEADS)
        )
        return one, two

    def wait(self) -> None:
        """Until the next pair of images is taken."""
        self.world.advance(self.world.time_s + FRAME_S)

    def shot(self, head: str) -> Shot:
        """What a head takes now."""
        scene = self.world.camera_scene(head)
        frame = render_frame(scene, self.look)
        left, right = np.frombuffer(frame.payload, np.uint8).reshape(2, frame.height, frame.width)
        return Shot(scene, (left, right))


def _sigma_in_part(pose: PartPose) -> Array:
    into_part = np.kron(np.eye(2), pose.pose.pose.rotation.inv().as_matrix())
    covariance = into_part @ pose.image_covariance @ into_part.T
    return in_mm_deg(np.sqrt(np.diag(covariance)))
