"""Deck against frame, measured in drawn fake cells without wire and clock, beside the truth."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.metrology.fake_station import FakeStation
from benchmarks.metrology.loop import Setting
from cellctl.geometry.pose import MM, Array, pose_error
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry, combined
from cellctl.vision.features.feature_file import FeatureFile
from cellctl.vision.registration.part_pose import PartPose
from cellctl.vision.registration.relative_pose import RelativePose, relative_pose
from fakes.scenes.deck_on_frame.scenario import DeckScenario


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredDeck:
    """One deck over one frame."""

    found: RelativePose
    off_truth: Array
    """Measured less true, shape (6,), in m and rad, in the axes of the frame."""


class MeasuringStation(FakeStation):
    """A station that knows where its parts are, so that nothing has to be found first."""

    def c1_T_part(self, part: str) -> RigidTransform:
        """True pose of frame or deck in head I, as it is in this moment."""
        parts, deck = self.world.placed.parts, self.world.cell_T_deck()
        assert parts is not None
        assert deck is not None
        cell_T_part = parts.cell_T_frame if part == "frame" else deck
        return self.world.camera_pose("head_1").inv() * cell_T_part

    def looks(
        self, part: str, features: FeatureFile, geometry: HeadGeometry, frames: int
    ) -> PartPose:
        """A part from so many frames."""
        predicted = self.c1_T_part(part)
        taken = [self._one_frame(features, predicted) for _ in range(frames)]
        return combined(features, taken, geometry, "default")[1]


def measured_deck(
    setting: Setting, scenario: DeckScenario, seed: int, geometry: HeadGeometry, frames: int
) -> MeasuredDeck:
    """The frame, then the deck at its stand-off."""
    recipe = setting.recipe
    station = MeasuringStation(scenario, seed, geometry)
    frame = station.looks("frame", setting.frame, geometry, frames)
    station.to_deck_measure()
    station.to_stand_off((recipe.deck_thickness_mm + recipe.stand_off_mm) * MM)
    deck = station.looks("deck", setting.deck, geometry, frames)
    found = relative_pose(
        frame.points,
        deck.points,
        frame.pose.pose,
        deck.pose.pose,
        geometry.c1_T_c2.covariance,
        sway_m=geometry.sway_m,
    )
    off = np.concatenate(pose_error(found.part_1_T_part_2.pose, station.true_frame_T_deck()))
    return MeasuredDeck(found, -off)
