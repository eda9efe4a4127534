"""How much of the frame's rims the heads see under a deck: what docs/operating.md says of it."""

import re
import tomllib
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from fakes.scenario_file.sections import StereoRig
from fakes.scenes.deck_on_frame.boards import measuring_flange
from fakes.scenes.deck_on_frame.parts import PartsTruth
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.world.frames import MM, Array
from fakes.world.scene import SceneHole

ROOT = Path(__file__).parents[5]
STAND_OFF_M = 10 * MM


def seen_share(eye: Array, frame: SceneHole, deck: SceneHole, gap_m: float, deck_m: float) -> float:
    """Share of a frame's rim that one camera sees through the hole of a deck that lies straight
    over it, ``gap_m`` above; ``eye`` is in the axes of the frame."""
    turn = np.linspace(0.0, 2 * np.pi, 720, endpoint=False)
    across = np.column_stack([np.cos(turn), np.sin(turn)]) * frame.diameter_m / 2
    rim = np.column_stack([across + frame.position_m, np.zeros(len(turn))])
    seen = np.ones(len(turn), dtype=bool)
    # A countersink of 90° ends as deep as it is wider than the bore on each side.
    open_m = 0.0 if deck.countersink_m is None else (deck.countersink_m - deck.diameter_m) / 2
    for height_m in (gap_m, gap_m + deck_m - open_m):
        passes = rim + (eye - rim) * (height_m / eye[2])
        beside_m = np.linalg.norm(passes[:, :2] - frame.position_m, axis=1)
        seen &= beside_m <= deck.diameter_m / 2 + 1e-9
    return float(seen.mean())


def eyes(world: DeckOnFrame, parts: PartsTruth, head: str) -> list[Array]:
    """Both cameras of a head that measures, in the axes of the frame."""
    scenario = world.scenario
    rig = scenario.optics[scenario.stereo_cameras[head].optics].stereo
    assert isinstance(rig, StereoRig)
    left = measuring_flange(scenario, head) * world.truth.cameras[head].mount_T_camera
    along = Rotation.from_euler("y", -np.deg2rad(rig.toe_in_deg / 2)).apply([1.0, 0.0, 0.0])
    places = [left.translation, left.apply(along * rig.baseline_mm * MM)]
    return [np.asarray(parts.cell_T_frame.inv().apply(place)) for place in places]


def test_no_rim_of_the_frame_is_seen_by_both_cameras_of_a_head() -> None:
    text = (ROOT / "config" / "deck.scenario.toml").read_text(encoding="utf-8")
    scenario = DeckScenario.model_validate(tomllib.loads(text))
    world = DeckOnFrame(scenario, 1)
    parts = world.placed.parts
    assert parts is not None
    deck = {hole.name: hole for hole in parts.deck_holes}
    best: dict[float, list[float]] = {0.0: [], STAND_OFF_M: []}
    for head, names in scenario.parts.seen_by.items():
        for frame in parts.frame_holes:
            if frame.name not in names:
                continue
            for gap_m, found in best.items():
                shares = [
                    seen_share(eye, frame, deck[frame.name], gap_m, parts.deck_thickness_m)
                    for eye in eyes(world, parts, head)
                ]
                found.append(min(shares))
    seated, at_stand_off = (round(100 * max(found)) for found in best.values())
    page = (ROOT / "docs" / "operating.md").read_text(encoding="utf-8")
    said = re.search(r"at most (\d+) % of a rim when the deck sits, (\d+) % at the stand-off", page)
    assert said
    assert (seated, at_stand_off) == (int(said[1]), int(said[2]))
