"""Light of a ring of lamps on a surface, by the direction of its normal: Lambert and one lobe."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial.transform import RigidTransform

from fakes.render.connectors.look import Lamps
from fakes.render.optics.lens import Array

_LAMPS = 48
_POLAR_STEP_DEG = 2.0
_AZIMUTH_STEP_DEG = 5.0


@dataclass(frozen=True, slots=True)
class Surface:
    """How a material throws light back."""

    diffuse: float
    lobe: float
    sharpness: float
    """Exponent of the lobe about the half vector."""


METAL = Surface(diffuse=0.75, lobe=0.55, sharpness=14.0)
PLASTIC = Surface(diffuse=1.0, lobe=0.03, sharpness=10.0)
PAPER = Surface(diffuse=1.0, lobe=0.0, sharpness=1.0)


@dataclass(frozen=True, slots=True, eq=False)
class Shading:
    """Brightness of one material under one lamp, seen along the camera's axis."""

    table: Array
    """Polar angle of the normal by its azimuth."""
    camera_R_body: Array

    @classmethod
    def of(cls, lamps: Lamps, surface: Surface, camera_T_body: RigidTransform) -> Self:
        """The table of a body: normals are given in its frame."""
        polar = np.radians(np.arange(0.0, 90.0 + _POLAR_STEP_DEG, _POLAR_STEP_DEG))[:, None, None]
        azimuth = np.radians(np.arange(0.0, 360.0 + _AZIMUTH_STEP_DEG, _AZIMUTH_STEP_DEG))
        lamp_azimuth = 2 * np.pi * np.arange(_LAMPS) / _LAMPS
        weights = lamps.weights(lamp_azimuth)
        delta = azimuth[None, :, None] - lamp_azimuth
        tilt = np.radians(lamps.polar_deg)
        towards = np.cos(polar) * np.cos(tilt) + np.sin(polar) * np.sin(tilt) * np.cos(delta)
        # Halfway between a lamp and the camera, which is straight above.
        half = tilt / 2
        lobe = np.cos(polar) * np.cos(half) + np.sin(polar) * np.sin(half) * np.cos(delta)
        value = surface.diffuse * np.maximum(towards, 0.0)
        value = value + surface.lobe * np.maximum(lobe, 0.0) ** surface.sharpness * (towards > 0)
        return cls(value @ weights, camera_T_body.rotation.as_matrix())

    def flat(self) -> float:
        """Brightness of a surface whose normal is the body's z."""
        zero, one = np.zeros(1), np.ones(1)
        return float(self.at(zero, zero, one)[0])

    def at(self, x: Array, y: Array, z: Array | float) -> Array:
        """Brightness of surfaces by their unit normals (x, y, z) in the frame of the body."""
        r = self.camera_R_body
        across = r[0, 0] * x + r[0, 1] * y + r[0, 2] * z
        down = r[1, 0] * x + r[1, 1] * y + r[1, 2] * z
        towards = -(r[2, 0] * x + r[2, 1] * y + r[2, 2] * z)
        polar = np.degrees(np.arccos(np.clip(towards, 0.0, 1.0))) / _POLAR_STEP_DEG
        azimuth = np.degrees(np.arctan2(down, across)) % 360.0 / _AZIMUTH_STEP_DEG
        return np.asarray(map_coordinates(self.table, [polar, azimuth], order=1, mode="nearest"))
