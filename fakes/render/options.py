"""Appearance of surfaces, light and sensor: everything that is not geometry."""

from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True, slots=True)
class RenderOptions:
    """Grey levels are those of a camera with gain 1 before noise; 255 is full scale."""

    plate_grey: float = 150.0
    floor_grey: float = 16.0
    """Background behind parts and boards."""
    dark_grey: float = 18.0
    """Bottom of a hole."""
    wall_grey: float = 70.0
    """Hole wall at its rim; falls off with depth."""
    cone_grey: float = 118.0
    """Countersink and chamfer, mean over the azimuth."""
    cone_contrast: float = 0.35
    """Relative brightness variation of a countersink with the azimuth."""
    thread_grey: float = 105.0
    """Crests and lit flanks of a thread near the rim."""
    thread_root_grey: float = 24.0
    white_grey: float = 190.0
    """Paper of boards and discs of the target board."""
    black_grey: float = 32.0
    """Print of boards and plate of the target board."""

    texture_grey: float = 4.0
    """Standard deviation of the brushed finish, of the plate's grey."""
    scratches_per_m2: float = 120.0
    false_circles_per_m2: float = 60.0
    """Stains, punch marks and blots; about a tenth of it is in one image."""

    light_gradient_per_m: float = 0.9
    """Relative change of the light along its direction."""
    light_ripple: float = 0.02
    """Relative amplitude of slow unevenness of the light."""
    light_ripple_m: float = 0.13
    """Its wavelength."""
    gloss: float = 0.10
    """Relative height of the soft highlight, at another place in each camera."""
    mirror: float = 0.0
    """Share of the way in a perfect mirror that the highlight moves when the surface tilts."""
    vignetting: float = 0.12
    """Relative loss of light in the corner of the image."""

    noise_grey: float = 2.0
    """Standard deviation of the noise at ``plate_grey``; 0 for none."""
    shot_share: float = 0.5
    """Part of that variance which is proportional to the grey level."""

    recessed_rims: bool = False
    """False: the rim that carries the centre lies in the face, as the feature files say, and the
    ring round it is flat. True: as machined at 90°, the rim lies below the face by the width of
    its countersink or chamfer."""
    sub_samples: int = 4
    """Cells a pixel side at holes, discs and printed edges."""

    @classmethod
    def clean(cls, **changes: Any) -> "RenderOptions":
        """Options with even light, flat surfaces, dark holes without visible walls, no noise."""
        even = cls(
            wall_grey=cls().dark_grey,
            thread_grey=cls().dark_grey,
            thread_root_grey=cls().dark_grey,
            cone_contrast=0.0,
            texture_grey=0.0,
            scratches_per_m2=0.0,
            false_circles_per_m2=0.0,
            light_gradient_per_m=0.0,
            light_ripple=0.0,
            gloss=0.0,
            vignetting=0.0,
            noise_grey=0.0,
        )
        return replace(even, **changes)
