"""What is imperfect about the devices and parts of a fake cell: names, sizes, their sources.

A scenario says in ``[imperfections]`` how many times its realistic size each imperfection has. Each
draws from a random stream of its own, so switching one on leaves the draws of all others as they
were.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True, slots=True)
class Imperfection:
    """One imperfection at its realistic size."""

    size: float
    """0 where the scenario file itself holds the sizes, under ``keys``."""
    unit: str
    acts: str
    """Where it acts, and how."""
    source: str
    """Where the size comes from; "assumed" where nobody has measured it."""
    drawn_by: Literal["hardware", "run"] | None = None
    """Seed that draws it: that of the hardware where it belongs to a device for its whole life,
    that of the run where it differs from day to day, part to part or motion to motion. None for
    what is the same in all cells: nothing of it is drawn."""
    keys: tuple[str, ...] = ()
    """Sizes in the scenario file that the scale multiplies, ``*`` for every device of a kind."""
    calibrated: bool = False
    """Belongs to the devices: another scale makes the calibrations of the cell wrong."""


CATALOGUE: Mapping[str, Imperfection] = {
    # -- arms ------------------------------------------------------------------------------------
    "links": Imperfection(
        0.0, "", "lengths and angles of every arm's links", "repeatable error of an industrial arm "
        "before its kinematic calibration, about 1 mm over the whole reach",
        keys=("robots.*.link_sigma_mm", "robots.*.link_sigma_deg", "robots.*.joint_sigma_deg"),
        calibrated=True,
        drawn_by="hardware",
    ),
    "repeatability": Imperfection(
        0.0, "", "pose of every arm at the end of a motion", "data sheets: ±0.05 mm and ±0.03 mm",
        keys=("robots.*.repeatability_mm", "robots.*.repeatability_deg", "robots.*.settling_mm",
              "robots.*.settling_deg"),
        drawn_by="run",
    ),
    "reducer_ripple": Imperfection(
        25.0, "arcsec", "joints of an arm that carries a force sensor: amplitude of the "
        "transmission error, which changes with the angle 40 times a turn",
        "data sheets of cycloidal (RV) reducers: at most 50 to 60 arcsec from peak to peak",
        drawn_by="hardware",
    ),
    "gravity_sag": Imperfection(
        15.0, "arcsec", "second and third joint of such an arm, stretched out level",
        "3 kN·m of payload on a reducer of 1 kN·m per arcmin; the controller corrects nine tenths",
    ),
    "base_drift": Imperfection(
        0.06, "mm", "base of every arm: offset since the calibrations, and as much in an hour",
        "a metre of steel, 5 K",
        drawn_by="run",
    ),
    "latency_jitter": Imperfection(
        10.0, "ms", "start of every motion: later by up to this much",
        "the job program polls its sockets once in an interpolation cycle of 4 to 12 ms",
        drawn_by="run",
    ),
    "stop_jitter": Imperfection(
        0.1, "ratio", "stop: the latency differs by up to this share, the brakes are weaker by up "
        "to it, anew each motion",
        "assumed; procedure 107 measures the spread on a real arm",
        drawn_by="run",
    ),
    # -- what the arm carries ----------------------------------------------------------------------
    "grip_slip": Imperfection(
        0.005, "mm", "deck in the gripper: shifts along each axis by up to this at every start of "
        "a motion, until the frame carries it",
        "assumed: a tenth of the loop's threshold",
        drawn_by="run",
    ),
    "deck_flex": Imperfection(
        0.02, "mm", "deck in the gripper: its corners hang lower than its middle by this",
        "15 mm of aluminium with 100 kg/m², held 250 mm inside its edge: q L⁴/(8 D)",
    ),
    "burr": Imperfection(
        0.02, "mm", "height of one burr somewhere under the rim of the deck",
        "edges without a burr as by ISO 13715: at most 0.02 to 0.05 mm",
        drawn_by="run",
    ),
    # -- force sensor ------------------------------------------------------------------------------
    "sensor_crosstalk": Imperfection(
        0.0, "", "matrix of the force sensor: gain of each channel, and between channels",
        "data sheets of six-axis sensors: 1 to 3 % of the range between channels",
        keys=("force_sensors.*.gain_sigma", "force_sensors.*.crosstalk_sigma"),
        calibrated=True,
        drawn_by="hardware",
    ),
    "sensor_noise": Imperfection(
        0.0, "", "every sample of the force sensor", "0.03 % of the range, white",
        keys=("force_sensors.*.noise_n", "force_sensors.*.noise_nm"),
        drawn_by="run",
    ),
    "sensor_hum": Imperfection(
        0.0, "", "reading of the force sensor at 12 Hz, from the swaying arm", "assumed",
        keys=("force_sensors.*.vibration_n",),
        drawn_by="run",
    ),
    "sensor_drift": Imperfection(
        0.0, "", "zero of the force sensor", "warming up: 0.01 % of the range in a minute",
        keys=("force_sensors.*.drift_n_per_min", "force_sensors.*.drift_nm_per_min"),
        drawn_by="hardware",
    ),
    "sensor_nonlinearity": Imperfection(
        0.002, "ratio of range", "reading of the force sensor: bent like x - x³",
        "data sheets of six-axis sensors: 0.2 to 0.5 % of the range",
        drawn_by="hardware",
    ),
    "sensor_hysteresis": Imperfection(
        0.002, "ratio of range", "reading of the force sensor, from branch to branch of a full "
        "cycle",
        "data sheets of six-axis sensors: 0.2 to 0.5 % of the range",
    ),
    "sensor_lag": Imperfection(
        1.0, "ms", "reading of the force sensor: time constant of its filter",
        "a bandwidth of 160 Hz, usual for strain gauges sampled at 1 kHz",
    ),
    # -- cameras -----------------------------------------------------------------------------------
    "lenses": Imperfection(
        0.0, "", "focal length, principal point and distortion of each lens", "assumed",
        keys=("optics.*.focal_spread_px", "optics.*.centre_spread_px",
              "optics.*.distortion_spread"),
        calibrated=True,
        drawn_by="hardware",
    ),
    "image_noise": Imperfection(
        0.0, "", "every pixel of every exposure: read noise", "industrial CMOS sensors in 8 bits",
        keys=("rendering.read_noise_levels",),
        drawn_by="run",
    ),
    "uneven_light": Imperfection(
        0.0, "", "light from one side of the image to the other", "ring light at 500 mm, assumed",
        keys=("rendering.light_gradient",),
        drawn_by="hardware",
    ),
    "lens_misfit": Imperfection(
        0.05, "px", "every lens: waves that the model with five parameters cannot follow",
        "parametric models against splined ones leave 0.05 to 0.3 px on real lenses",
        calibrated=True,
        drawn_by="hardware",
    ),
    "head_drift": Imperfection(
        0.015, "mm", "mount of every camera: offset since the calibrations, and as much in an hour",
        "120 mm of aluminium, 5 K",
        drawn_by="run",
    ),
    "vibration": Imperfection(
        10.0, "µrad", "line of sight of every camera at 12 Hz, root mean square; smears it too",
        "a floor with 0.4 mm/s (the ISO limit of offices): 5 µm at 12 Hz, at a distance of 0.5 m",
        drawn_by="run",
    ),
    "exposure_drift": Imperfection(
        0.02, "ratio", "brightness of every exposure", "LED light: 0.4 % per K, 5 K",
        drawn_by="run",
    ),
    "glare": Imperfection(
        0.1, "ratio", "highlight in the picture of every camera, beside the 0.1 that it has anyway",
        "assumed; a worn or oily milled face",
        drawn_by="hardware",
    ),
    "tilt_shading": Imperfection(
        1.0, "ratio", "highlight: moves with the tilt of the surface as in a mirror", "geometry",
    ),
}  # fmt: skip


class UnknownImperfection(ValueError):
    """A name that the catalogue does not have, or a scale that is no number of at least 0."""


def parsed_scale(text: str) -> tuple[str, float]:
    """Name and scale from ``NAME=SCALE``; raises ``UnknownImperfection``."""
    name, _, written = text.partition("=")
    try:
        scale = float(written)
    except ValueError:
        raise UnknownImperfection(f"expected NAME=SCALE as in links=2, got {text!r}") from None
    check_scales({name: scale})
    return name, scale


def check_scales(scales: Mapping[str, float]) -> None:
    """Raise ``UnknownImperfection`` for the first that is not in the catalogue, or below 0."""
    for name, scale in scales.items():
        if name not in CATALOGUE:
            known = ", ".join(sorted(CATALOGUE))
            raise UnknownImperfection(f"there is no imperfection {name!r}; there are: {known}")
        if not isinstance(scale, int | float) or not 0 <= scale < float("inf"):
            raise UnknownImperfection(f"scale of {name!r} is {scale}, must be a number from 0")


def scale_written(written: Mapping[str, Any], scales: Mapping[str, float]) -> dict[str, Any]:
    """A scenario file's content with the sizes that it holds itself made so many times larger."""
    result = dict(written)
    for name, scale in scales.items():
        for key in CATALOGUE[name].keys:
            result = _multiplied(result, key.split("."), scale)
    return result


def _multiplied(table: Any, path: list[str], scale: float) -> Any:
    """A copy in which the value at ``path``, or each number of it, is multiplied."""
    if not path:
        return (
            [_multiplied(one, [], scale) for one in table]
            if isinstance(table, list)
            else (table * scale)
        )
    name, *rest = path
    names = list(table) if name == "*" else [name] if name in table else []
    return dict(table) | {one: _multiplied(table[one], rest, scale) for one in names}
