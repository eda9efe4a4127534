"""How a deck hangs through: its rim lies lower than its middle, where the gripper holds it.

The frame of the deck, as on the drawing, is that of its holes: their mean height is z = 0.
"""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.frames import MM, Array


def hang_m(scenario: DeckScenario, places_m: Array) -> Array:
    """How much lower than its holes the deck is at places x, y of it, shape (n, 2)."""
    holes_m = np.array([hole.position_mm for hole in scenario.parts.holes]) * MM
    shape = _shape(scenario, places_m) - _shape(scenario, holes_m).mean()
    return np.asarray(_corner_m(scenario) * shape)


def deck_T_tangent(scenario: DeckScenario, camera_T_deck: RigidTransform) -> RigidTransform:
    """The flat deck that a camera takes the bent one for: it touches it on the line of sight.

    50 mm beside the line of sight the bent deck leaves it by 2 % of what its corners hang.
    """
    corner_m = _corner_m(scenario)
    if not corner_m:
        return RigidTransform.identity()
    half_m = np.array(scenario.parts.size_mm) / 2 * MM
    place_m = np.clip(_line_of_sight_meets(camera_T_deck), -half_m, half_m)
    slope_x, slope_y = corner_m * place_m / half_m**2
    turn = Rotation.from_rotvec([-slope_y, slope_x, 0.0])
    touched = np.array([*place_m, 0.0])
    lowered = touched - [0.0, 0.0, hang_m(scenario, place_m[np.newaxis])[0]]
    return RigidTransform.from_components(lowered - turn.apply(touched), turn)


def _shape(scenario: DeckScenario, places_m: Array) -> Array:
    """0 in the middle and 1 at the corners."""
    half_m = np.array(scenario.parts.size_mm) / 2 * MM
    return np.asarray(((places_m / half_m) ** 2).mean(axis=1))


def _corner_m(scenario: DeckScenario) -> float:
    return scenario.size_of("deck_flex") * MM


def _line_of_sight_meets(camera_T_deck: RigidTransform) -> Array:
    """Where x, y of the deck's face lie on the optical axis."""
    deck_T_camera = camera_T_deck.inv()
    eye = deck_T_camera.translation
    ahead = deck_T_camera.rotation.apply([0.0, 0.0, 1.0])
    return np.asarray((eye - ahead * eye[2] / ahead[2])[:2])
