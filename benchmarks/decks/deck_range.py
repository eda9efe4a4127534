"""The decks that are tried, and how the shipped cell and its recipe have to change for each."""

from dataclasses import dataclass, replace
from math import degrees, hypot

import numpy as np
from scipy.spatial.transform import RigidTransform

from benchmarks.metrology.loop import Setting
from cellctl.geometry.pose import MM
from cellctl.geometry.uncertain import UncertainPose, skew
from cellctl.processes.deck_to_frame.checks.plausible.face import face_issues
from cellctl.processes.deck_to_frame.mating.settings import FAST_LIMIT_N
from cellctl.processes.deck_to_frame.poses.part_measurer import HeadGeometry
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.vision.features.feature_file import FeatureFile
from fakes.scenario_file.sections import Spread
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.world.frames import Array

SHIPPED_FACE_MM = np.array([1000.0, 500.0])
SHIPPED_LEGS_MM = 100.0
LARGE_LEGS_MM = 150.0
"""A head's field holds no larger triangle beside the tolerance of the station."""
MIDDLE_OF_TRIANGLE_MM = np.array([46.7, 86.7])
"""Middle of the shipped holes, from the corner; the heads look there."""
GRIPPER_KG, GRIPPER_COM_MM = 150.0, np.array([38.0, 25.0, 385.0])
DECK_COM_MM = np.array([6.0, 5.0, 445.0])
"""Centre of mass in the sensor's frame, as in the shipped scenario."""
GRIPPER_INERTIA = np.array([8.0, 9.0, 6.0])
SENSOR_RANGE_N = 5000.0
RANGE_IN_USE = 0.8
"""Share of the sensor's range that the hanging weight may use; contact needs the rest."""
WEAK_AXIS_DEG = 0.0037
"""What two triangles of 100 mm tell of the rotation about the line between them: standard deviation
(docs/metrology.md, "Triangles of 100 mm")."""
SHARE_OF_ONE_PART = 0.3
"""Share of a threshold that each part's own standard deviation may use."""
LEAST_THRESHOLD_DEG = 0.006
LEFT_FOR_STRAIGHT_TRAVEL_MM = 0.03


@dataclass(frozen=True, slots=True)
class Deck:
    """One product."""

    mass_kg: float
    length_m: float
    """Along x, from one head to the other."""
    width_m: float
    legs_mm: float = SHIPPED_LEGS_MM
    """Distance from the pin hole to each of its neighbours."""

    @property
    def key(self) -> str:
        """Tells it from all others."""
        return f"{self.mass_kg:g}kg-{self.length_m:g}x{self.width_m:g}m-{self.legs_mm:g}mm"

    @property
    def face_mm(self) -> Array:
        """Length and width."""
        return np.array([self.length_m, self.width_m]) * 1e3

    @property
    def half_diagonal_m(self) -> float:
        """Distance from the middle to a corner."""
        return hypot(self.length_m, self.width_m) / 2

    @property
    def head_shift_mm(self) -> Array:
        """How much farther out the second head looks than on the shipped deck."""
        inward_mm = MIDDLE_OF_TRIANGLE_MM * (self.legs_mm / SHIPPED_LEGS_MM - 1.0)
        return np.asarray((self.face_mm - SHIPPED_FACE_MM) / 2 - inward_mm)


DECKS = (
    Deck(10.0, 1.0, 1.0),
    Deck(25.0, 1.0, 0.5),
    Deck(50.0, 1.0, 0.5),
    Deck(100.0, 1.5, 1.0),
    Deck(200.0, 2.0, 1.0),
    Deck(200.0, 3.0, 1.5),
    Deck(350.0, 4.0, 2.0),
    Deck(500.0, 2.0, 2.0),
    Deck(500.0, 5.0, 2.0),
)
"""Each is tried with triangles of 100 mm, and again with those that fill the field of a head."""


def place_mm(deck: Deck, shipped_mm: Array) -> Array:
    """Where a hole of the shipped deck is on this one: its way from the corner, scaled."""
    side = np.sign(shipped_mm[0])  # head I sees the corner where x and y are smallest
    from_corner = side * SHIPPED_FACE_MM / 2 - shipped_mm
    return np.asarray(side * deck.face_mm / 2 - from_corner * deck.legs_mm / SHIPPED_LEGS_MM)


def scenario_of(deck: Deck, shipped: DeckScenario) -> DeckScenario:
    """The fake cell for a deck: heads over its corners, a sensor that carries its weight."""
    parts = shipped.parts
    holes = tuple(
        hole.model_copy(update={"position_mm": tuple(place_mm(deck, np.array(hole.position_mm)))})
        for hole in parts.holes
    )
    mass_kg = GRIPPER_KG + deck.mass_kg
    com_mm = (GRIPPER_KG * GRIPPER_COM_MM + deck.mass_kg * DECK_COM_MM) / mass_kg
    length_m, width_m = deck.length_m, deck.width_m
    of_deck = np.array([width_m**2, length_m**2, length_m**2 + width_m**2]) * deck.mass_kg / 12
    payload = shipped.payload.model_copy(
        update={
            "deck_kg": deck.mass_kg,
            "com_in_sensor_mm": tuple(com_mm),
            "inertia_kg_m2": tuple(GRIPPER_INERTIA + of_deck),
        }
    )
    return shipped.model_copy(
        update={
            "parts": parts.model_copy(
                update={
                    "size_mm": tuple(deck.face_mm),
                    "holes": holes,
                    "frame_displacement": _located(deck, parts.frame_displacement),
                    "grip": _located(deck, parts.grip),
                }
            ),
            "payload": payload,
            "force_sensors": {
                name: sensor.model_copy(update=_larger(sensor.model_dump(), mass_kg))
                for name, sensor in shipped.force_sensors.items()
            },
            "robots": {
                name: robot.model_copy(
                    update={"base_mm_deg": _moved(deck, name, robot.base_mm_deg)}
                )
                for name, robot in shipped.robots.items()
            },
            "taught": {
                name: {pose: _moved(deck, name, written) for pose, written in poses.items()}
                for name, poses in shipped.taught.items()
            },
        }
    )


def setting_of(deck: Deck, shipped: Setting) -> Setting:
    """Recipe, drawings and calibrations for a deck; the heads are calibrated as well as shipped."""
    base_T_c1 = _shift(deck, "aux_1") * shipped.base_T_c1
    base_T_c2 = _shift(deck, "aux_2") * (shipped.base_T_c1 * shipped.geometry.c1_T_c2)
    c1_T_c2 = _farther_apart(deck, base_T_c1, base_T_c2.pose, shipped.geometry.c1_T_c2)
    return Setting(
        recipe_of(deck, shipped.recipe),
        base_T_c1,
        HeadGeometry(
            shipped.geometry.head_1, shipped.geometry.head_2, c1_T_c2, shipped.geometry.sway_m
        ),
        _drawing(deck, shipped.frame),
        _drawing(deck, shipped.deck),
    )


def recipe_of(deck: Deck, shipped: DeckRecipe) -> DeckRecipe:
    """The shipped recipe with the figures that a face of this size needs."""
    length_mm, width_mm = deck.face_mm
    correction, mating = shipped.pose_correction, shipped.mating
    # The weak axis is the line from head to head. What is unknown about it is unknown about x and y
    # by the cosines of its direction.
    weak_deg = WEAK_AXIS_DEG * SHIPPED_LEGS_MM / deck.legs_mm / SHARE_OF_ONE_PART
    about_x = max(LEAST_THRESHOLD_DEG, 1.1 * weak_deg * length_mm / hypot(length_mm, width_mm))
    about_y = max(LEAST_THRESHOLD_DEG, 1.1 * weak_deg * width_mm / hypot(length_mm, width_mm))
    spare_mm = (
        shipped.seated_limit_mm
        - hypot(correction.threshold_mm, correction.threshold_mm)
        - LEFT_FOR_STRAIGHT_TRAVEL_MM
    )
    about_z = min(LEAST_THRESHOLD_DEG, degrees(spare_mm * MM / deck.half_diagonal_m))
    return shipped.model_copy(
        update={
            "face_mm": (float(length_mm), float(width_mm)),
            "pose_correction": correction.model_copy(
                update={
                    "threshold_deg": about_y,
                    "threshold_about_x_deg": about_x,
                    "threshold_about_z_deg": about_z,
                }
            ),
            "mating": mating.model_copy(
                update={
                    "max_moment_n_m": max(
                        mating.max_moment_n_m,
                        1.2 * mating.target_force_n * deck.half_diagonal_m,
                    ),
                    # A heavy load begins to move slowly, so that it is not taken for a contact.
                    "acceleration_mm_s2": min(
                        mating.acceleration_mm_s2, 0.7 * FAST_LIMIT_N / 2 / payload_kg(deck) * 1e3
                    ),
                }
            ),
        }
    )


def refusals(deck: Deck, shipped: Setting) -> list[str]:
    """What `cellctl check` says to the recipe of a deck."""
    recipe = recipe_of(deck, shipped.recipe)
    return [str(issue) for issue in face_issues(recipe, "recipe", _drawing(deck, shipped.deck))]


def payload_kg(deck: Deck) -> float:
    """Everything that hangs on the sensor."""
    return GRIPPER_KG + deck.mass_kg


def _located(deck: Deck, shipped: Spread) -> Spread:
    """Its corners are located and gripped as exactly as those of the shipped deck."""
    ratio = float(np.hypot(*SHIPPED_FACE_MM)) * MM / 2 / deck.half_diagonal_m
    turned = tuple(angle * ratio for angle in shipped.rotation_deg)
    return shipped.model_copy(update={"rotation_deg": turned})


def _larger(sensor: dict[str, object], mass_kg: float) -> dict[str, float]:
    """Range of a sensor for the weight, and what is a share of its range."""
    ratio = max(1.0, mass_kg * 9.81 / (RANGE_IN_USE * SENSOR_RANGE_N))
    scaled = ("range_n", "range_nm", "noise_n", "noise_nm", "drift_n_per_min", "drift_nm_per_min")
    return {key: float(str(sensor[key])) * ratio for key in scaled}


def _drawing(deck: Deck, shipped: FeatureFile) -> FeatureFile:
    holes = tuple(
        replace(
            hole,
            position_m=np.array(
                [*place_mm(deck, hole.position_m[:2] / MM) * MM, hole.position_m[2]]
            ),
        )
        for hole in shipped.holes
    )
    return replace(shipped, holes=holes)


def _farther_apart(
    deck: Deck, base_T_c1: UncertainPose, base_T_c2: RigidTransform, shipped: UncertainPose
) -> UncertainPose:
    """C1_T_C2 of heads that stand farther apart: how head I stands is known no better than before,
    and now has a longer lever."""
    apart_m = (_shift_mm(deck, "aux_2") - _shift_mm(deck, "aux_1")) * MM
    lever = skew(base_T_c1.pose.rotation.inv().apply(apart_m))
    covariance = shipped.covariance.copy()
    covariance[:3, :3] += lever @ base_T_c1.covariance[3:, 3:] @ lever.T
    return UncertainPose(base_T_c1.pose.inv() * base_T_c2, covariance)


def _shift(deck: Deck, robot: str) -> UncertainPose:
    """How far a head has moved in the cell. The frame stands turned by 90 degrees in it."""
    return UncertainPose.exact(RigidTransform.from_translation(_shift_mm(deck, robot) * MM))


def _shift_mm(deck: Deck, robot: str) -> Array:
    side = {"aux_1": -1.0, "aux_2": 1.0}.get(robot, 0.0)
    along_x, along_y = side * deck.head_shift_mm
    return np.array([-along_y, along_x, 0.0])


def _moved(
    deck: Deck, robot: str, written: tuple[float, ...]
) -> tuple[float, float, float, float, float, float]:
    x, y, z = _shift_mm(deck, robot) + written[:3]
    return (float(x), float(y), float(z), *written[3:6])  # type: ignore[return-value]
