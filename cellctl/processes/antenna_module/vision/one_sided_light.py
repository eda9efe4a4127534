"""Refuses an image whose light comes from one side.

The slanted surface round every contact, the chamfer of a pin or the funnel of a hole, is bright
towards the lamp. On the other side it is as dark as what it borders on, and the border is not seen
there. Rendered pins are then measured up to 50 µm too near to the lamp, holes 100 µm and more too
far from it, at a standard deviation that looks like that of a good image: all contacts are off
together, so no residual shows it.
"""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import map_coordinates

from cellctl.geometry.pose import Array
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.antenna_module.connector.connector import Connector
from cellctl.processes.antenna_module.faults.connector import LightFromOneSide
from cellctl.processes.antenna_module.vision.contact_fit.circle_fit import Circle
from cellctl.processes.antenna_module.vision.plane import MeasuringPlane

_MOST = 0.42
"""Most of the light's first harmonic over its mean. A ring that is brighter by 60 % on one side has
0.40 at most and moves rendered pins by less than a micrometre; a ring of which a third is lit has
at least 0.49, and moves them by up to 30 µm."""
_WIDEST = 1.14
"""Most of the rims' radius over the drawing's. Blur makes holes larger by up to 9 %; where the dark
side of the funnel is taken for a part of the hole they are larger by 18 % and more."""
_RADIUS = 1.7
"""From this ratio on the drawing may state radii in place of diameters."""
_DIRECTIONS = 48
_FLAT_TIP = 0.8
"""Share of the radius within which the tip of a pin without chamfer is looked at."""


def require_light_from_all_sides(
    image: Image, plane: MeasuringPlane, connector: Connector, rims: Sequence[Circle]
) -> None:
    """Raise ``LightFromOneSide``; ``rims`` are those of the clean contacts, in ``plane``."""
    wide = float(np.median([rim.radius_m for rim in rims])) * 2.0 / connector.diameter_m
    if wide > _WIDEST:
        drawn = "; or is diameter_mm of the drawing the radius?" if wide > _RADIUS else ""
        raise LightFromOneSide(
            f"rims are {wide - 1.0:.0%} wider than drawn, at most {_WIDEST - 1.0:.0%}: one side of "
            f"what surrounds them is dark{drawn}"
        )
    centres_m = np.array([rim.centre_m for rim in rims])
    share = one_sidedness(image, plane, centres_m, slant_radius_m(connector))
    if share > _MOST:
        raise LightFromOneSide(
            f"brighter on one side by {share:.0%} of the mean, at most {_MOST:.0%}"
        )


def slant_radius_m(connector: Connector) -> float:
    """Where the slanted surface round a contact is, from its middle."""
    rim_m = connector.diameter_m / 2.0
    if connector.kind == "holes":
        return rim_m + connector.capture_m / 2.0
    return rim_m - connector.chamfer_m / 2.0 if connector.chamfer_m else _FLAT_TIP * rim_m


def one_sidedness(image: Image, plane: MeasuringPlane, centres_m: Array, radius_m: float) -> float:
    """First harmonic over mean of the grey levels on circles round the contacts, their median.

    The median of the vectors, because single contacts reflect in their own way and the lamp is the
    same for all.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
    unit = np.column_stack([np.cos(angles), np.sin(angles)])
    vectors = []
    for centre in centres_m:
        px = plane.to_px(centre + radius_m * unit)
        grey = map_coordinates(image.astype(np.float32), px.T[::-1], order=1, mode="nearest")
        vectors.append(2.0 * (grey @ unit) / _DIRECTIONS / max(float(grey.mean()), 1.0))
    return float(np.linalg.norm(np.median(vectors, axis=0)))
