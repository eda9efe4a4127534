"""Appearance of connectors: lamps, surfaces, sensor; everything that is not geometry."""

from dataclasses import dataclass, field

import numpy as np

from fakes.render.options import RenderOptions
from fakes.scenario_file.sections import RingLamp


@dataclass(frozen=True, slots=True)
class Lamps:
    """Lamps on a circle round the axis of the camera, far away."""

    polar_deg: float = 60.0
    """Angle between a lamp's rays and the camera's axis; 90 would graze the face."""
    one_sided: float = 0.0
    """Share by which the ring is brighter on one side, and darker on the other."""
    azimuth_rad: float = 0.0
    """Where the bright side is, from the image's x towards its y."""
    arc_deg: float | None = None
    """Length of the lit arc; None for the whole ring, about 40 for a lamp at one side."""

    def weights(self, azimuths_rad: np.ndarray) -> np.ndarray:
        """Relative power of lamps at these azimuths, in sum 1."""
        away = (azimuths_rad - self.azimuth_rad + np.pi) % (2 * np.pi) - np.pi
        power = 1 + self.one_sided * np.cos(away)
        if self.arc_deg is not None:
            power = power * np.exp(-0.5 * (away / np.radians(self.arc_deg / 2)) ** 2)
        return np.asarray(power / power.sum())


def lamps_of(lamp: RingLamp) -> Lamps:
    """The lamps that a scenario gives to a camera."""
    return Lamps(lamp.polar_deg, lamp.one_sided, float(np.radians(lamp.azimuth_deg)), lamp.arc_deg)


def _sensor() -> RenderOptions:
    """Light, noise and cells of the general renderer; its surfaces are not used here."""
    return RenderOptions.clean(
        noise_grey=2.0, light_gradient_per_m=1.0, vignetting=0.04, texture_grey=4.0
    )


@dataclass(frozen=True, slots=True)
class ConnectorLook:
    """How connectors look under a lamp; ``sensor`` brings noise and unevenness of the light."""

    lamps: Lamps = Lamps()
    exposure: float = 420.0
    """Grey level of a white surface that is lit from straight above."""
    wall_light: float = 0.5
    """Part of the light that reaches the walls of pins, next to each other and inside the shell;
    0 for dark walls, 1 for free-standing ones."""
    hole_light: float = 0.15
    """The same for the bore of a hole."""
    sensor: RenderOptions = field(default_factory=_sensor)
