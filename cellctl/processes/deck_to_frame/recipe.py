"""The recipe of this process: what is assembled and within which bounds (mission A2-A4)."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from cellctl.config.base import LessSafe, Section, WrittenPose
from cellctl.config.recipe import Recipe

Length = Annotated[float, Field(gt=0, le=5000)]


class PoseCorrection(Section):
    """The measure-correct loop (paper 2.3)."""

    threshold_mm: Annotated[float, Field(gt=0, le=1)] = 0.05
    """The deck counts as aligned when each coordinate is off by no more (paper eq. 16)."""
    threshold_deg: Annotated[float, Field(gt=0, le=1)] = 0.005
    """The same for the rotation about each axis."""
    threshold_about_x_deg: Annotated[float, Field(gt=0, le=1)] | None = None
    """About x of the frame, which is known least where x is the line from head to head; None: as
    about the other axes."""
    threshold_about_z_deg: Annotated[float, Field(gt=0, le=1)] | None = None
    """About z of the frame, which is known best of all, and shifts the pins of a long deck aside;
    None: as about y."""
    max_iterations: Annotated[int, Field(ge=1, le=50)] = 10
    """Corrections after which the loop is given up."""
    max_correction_mm: Annotated[float, Field(gt=0, le=50)] = 10.0
    """Largest single correction: a greater one says that something was measured wrongly."""
    max_correction_deg: Annotated[float, Field(gt=0, le=10)] = 1.5
    """The same for the rotation."""
    frames: Annotated[int, Field(ge=1, le=50)] = 2
    """Pairs a head takes for one measurement to begin with."""
    max_frames: Annotated[int, Field(ge=1, le=200)] = 12
    """Pairs after which a measurement that is still too uncertain is given up."""
    heads_drift_mm: Annotated[float, Field(gt=0, le=1)] = 0.1
    """How far a head may have moved against the other since the board transfer; standard deviation
    along each axis: a metre of steel at 5 K, twice."""
    heads_drift_deg: Annotated[float, Field(gt=0, le=0.1)] = 0.01
    """The same about each axis."""
    heads_sway_mm: Annotated[float, Field(ge=0, le=0.1)] = 0.005
    """How far a head sways in one picture, across its line of sight: standard deviation of each
    axis. That of a floor with 0.4 mm/s (ISO 2631-2, offices) at 12 Hz; the scatter of pictures of a
    part at rest tells it."""
    rule: Literal["compose", "paper"] = "compose"
    """Pose composition, or the paper's componentwise Euler accumulation for comparison."""
    method: Literal["default", "paper"] = "default"
    """Hole measurement: the default, or the paper's image steps for comparison."""

    @property
    def thresholds_deg(self) -> tuple[float, float, float]:
        """About x, y and z of the frame."""
        about_x_deg, about_z_deg = self.threshold_about_x_deg, self.threshold_about_z_deg
        return _about_axes(self.threshold_deg, about_x_deg, about_z_deg)


class PinSearch(Section):
    """Pins that stand on the deck beside their holes are looked for at places round the measured
    one."""

    radius_mm: Annotated[float, Field(gt=0, le=1)]
    """Within this of the measured place."""
    catch_mm: Annotated[float, Field(ge=0.02, le=1)]
    """A pin so far beside its hole still enters: clearance and both chamfers."""

    @model_validator(mode="after")
    def _few_places(self) -> Self:
        if self.radius_mm > 3 * self.catch_mm:
            raise ValueError("radius_mm is more than three times catch_mm: too many places")
        return self


class Pins(Section):
    """Pins that enter the deck's holes before it sits (our extension of the paper)."""

    engagement_mm: Annotated[float, Field(gt=0, le=50)]
    """The deck meets them so far above its seat: fast travel ends before."""
    compliance: bool = True
    """Give way to them across the approach; else any contact above the seat is a fault."""
    max_travel_mm: Annotated[float, Field(gt=0, le=2)] = 0.2
    """How far it may give way altogether."""
    max_yaw_deg: Annotated[float, Field(gt=0, le=1)] = 0.03
    """How far it may turn."""
    lateral_stiffness_n_per_mm: Annotated[float, Field(ge=10, le=20_000)] | None = None
    """Upper bound of what is felt across the approach, the robot's own is a safe choice; None:
    ``stiffness_n_per_mm`` of the mating."""
    yaw_stiffness_n_m_per_deg: Annotated[float, Field(ge=10, le=200_000)] = 5300.0
    """The same about the approach. Too high only makes more moves."""
    search: PinSearch | None = None
    """None: pins that stand on the deck are a fault."""

    @model_validator(mode="after")
    def _search_gives_way(self) -> Self:
        if self.search is None:
            return self
        if not self.compliance:
            raise ValueError("search needs compliance: the pins that it finds push sideways")
        if self.search.radius_mm > self.max_travel_mm:
            raise ValueError("search.radius_mm is beyond max_travel_mm")
        return self


class Mating(Section):
    """Force-limited mating (paper 2.4.2, mission A4)."""

    target_force_n: Annotated[float, Field(ge=5, le=200), LessSafe.WITH_MORE] = 35.0
    """F_t of the paper: also the predicted peak of the touch and the least force of a seat."""
    limit_force_n: Annotated[float, Field(ge=10, le=500), LessSafe.WITH_MORE] = 50.0
    """Force along the approach that must never be exceeded."""
    touch_force_n: Annotated[float, Field(ge=2, le=50), LessSafe.WITH_MORE] = 8.0
    """A force that counts as a touch: the drift of the touch detector is half of it."""
    release_force_n: Annotated[float, Field(ge=6, le=100)] = 15.0
    """Left on the joint for fastening after the hold."""
    max_lateral_force_n: Annotated[float, Field(gt=0, le=500), LessSafe.WITH_MORE] = 25.0
    """Across the approach, at any moment; the seated deck may keep four fifths of it."""
    max_moment_n_m: Annotated[float, Field(gt=0, le=500), LessSafe.WITH_MORE] = 25.0
    """About each axis, at any moment; it must leave room for a deck that rests on an edge."""
    max_untared_force_n: Annotated[float, Field(gt=0, le=500)] = 80.0
    """What the compensation may leave at the stand-off before the tare, about 4 % of the weight;
    more is another payload or a deck that touches. The defaults fit 200 kg."""
    max_untared_moment_n_m: Annotated[float, Field(gt=0, le=500)] = 40.0
    """The same for the moment."""
    max_past_contact_mm: Annotated[float, Field(gt=0, le=2)] = 0.5
    """No target is commanded farther past the expected contact."""
    contact_window_mm: Annotated[float, Field(gt=0, le=3)] = 0.3
    """Contact earlier or later than expected by more than this is a fault."""
    fast_speed_mm_s: Annotated[float, Field(gt=0, le=20)] = 5.0
    """Speed while contact is excluded; what vision has not seen is met at it."""
    unexpected_force_n: Annotated[float, Field(ge=50, le=20_000), LessSafe.WITH_MORE] | None = None
    """What deck, frame and gripper take without harm where ``fast_speed_mm_s`` meets a deck that is
    thicker than stated: from their strength analysis. None: nobody says."""
    acceleration_mm_s2: Annotated[float, Field(gt=0, le=200)] = 20.0
    """Acceleration of all straight moves of the mating: its inertia has to stay far below a
    contact."""
    stop_latency_ms: Annotated[float, Field(ge=1, le=2000), LessSafe.WITH_LESS]
    """Upper bound, used while procedure 107 has no valid result; 107 does not pass beyond it."""
    stiffness_n_per_mm: Annotated[float, Field(ge=10, le=20_000)]
    """Robot and joint in series: upper bound, used while procedure 108 has no valid result for
    this recipe; 108 does not pass beyond it. The robot's own stiffness is a safe choice. With
    ``pins`` it is the choice: they are approached by this figure, whatever 108 has measured."""
    travel_sigma_mm: Annotated[float, Field(gt=0, le=1)]
    """What the arm is off after a straight move over the stand-off distance: from its data sheet or
    from a measurement with a tracker; standard deviation."""
    step_sigma_mm: Annotated[float, Field(gt=0, le=0.1)]
    """The same for the length of a single move of a few hundredths of a millimetre."""
    part_spread_ratio: Annotated[float, Field(ge=1, le=10)] = 1.5
    """Other parts of this recipe may be so much stiffer than those of procedure 108."""
    max_tries: Annotated[int, Field(ge=1, le=5)] = 3
    """Attempts after a false seat, each measured anew, before the run is given up."""
    pins: Pins | None = None
    """None: no pins are met while mating."""

    @model_validator(mode="after")
    def _forces_rise(self) -> Self:
        if not self.release_force_n < self.target_force_n < self.limit_force_n:
            raise ValueError("must be so: release_force_n < target_force_n < limit_force_n")
        return self


class DeckRecipe(Recipe):
    """One product: parts, distances, thresholds."""

    process: Literal["deck-to-frame"]
    frame_features: str
    """Feature file, relative to the cell file."""
    deck_features: str
    """The same for the deck."""
    deck_thickness_mm: Annotated[float, Field(gt=0, le=200)]
    """D1 of the paper."""
    deck_thickness_sigma_mm: Annotated[float, Field(gt=0, le=1)]
    """Standard deviation of the thickness over the parts: from the drawing, its tolerance over the
    root of three, or from measured parts."""
    face_mm: tuple[Length, Length] = (1000.0, 500.0)
    """Length along x and width along y of the mating face: a tilted deck touches with an edge."""
    stand_off_mm: Annotated[float, Field(gt=0, le=100)]
    """D2 of the paper."""
    over_travel_mm: Annotated[float, Field(gt=0, le=100)]
    """D3 of the paper: the hard end of travel, never a target."""
    base_T_frame: WrittenPose
    """Where the frame stands, roughly."""
    flange_T_deck: WrittenPose
    """How the deck is gripped, roughly."""
    station_tolerance_mm: Annotated[float, Field(gt=0, le=100)] = 15.0
    """A frame or deck measured farther than this from its nominal place is refused."""
    station_tolerance_deg: Annotated[float, Field(gt=0, le=20)] = 3.0
    """The same for its rotation."""
    seated_limit_mm: Annotated[float, Field(gt=0, le=5)] = 0.2
    """Lateral offset at a pin hole that the seated deck may have."""
    seated_gap_limit_mm: Annotated[float, Field(gt=0, le=5)] = 0.1
    """Distance between deck and frame, in the middle of the face, that the cameras may see."""
    seated_limit_deg: Annotated[float, Field(gt=0, le=5)] = 0.01
    """Rotation about any axis of the frame that the seated deck may have."""
    seated_limit_about_x_deg: Annotated[float, Field(gt=0, le=5)] | None = None
    """About x of the frame; None: as about the other axes."""
    pose_correction: PoseCorrection = PoseCorrection()
    mating: Mating

    @property
    def seated_limits_deg(self) -> tuple[float, float, float]:
        """About x, y and z of the frame."""
        return _about_axes(self.seated_limit_deg, self.seated_limit_about_x_deg)

    def files(self) -> Mapping[str, str]:
        """The feature files."""
        return {
            "frame_features.toml": self.frame_features,
            "deck_features.toml": self.deck_features,
        }


def _about_axes(
    deg: float, about_x_deg: float | None, about_z_deg: float | None = None
) -> tuple[float, float, float]:
    about_x = deg if about_x_deg is None else about_x_deg
    return (about_x, deg, deg if about_z_deg is None else about_z_deg)
