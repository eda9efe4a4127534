"""Where a stereo head sees well, and what its images are like."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ImageQuality:
    """What the images of a head are like: figures that any pair of images of the parts shows."""

    contrast_grey: float
    """Step of grey across a rim."""
    noise_grey: float
    """Standard deviation of a pixel, with the texture of the face."""
    blur_px: float
    """Standard deviation of the optical blur."""


@dataclass(frozen=True, slots=True)
class HeadLimits:
    """What the model says of one head."""

    nearest_m: float
    """Least distance along the line of sight at which a rim is sharp."""
    farthest_m: float
    margin_px: float
    """Least distance between a rim and the edge of the image."""
    greatest_angle_rad: float
    """Greatest angle between a line of sight and the axis of a bore."""
    lit_within_rad: float
    """Greatest angle between the axis of the lamp and the way to a hole."""
    quality: ImageQuality
