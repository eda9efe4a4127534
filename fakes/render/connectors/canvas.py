"""The picture under construction in one or three channels, and the patches laid over it."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from fakes.render.connectors.colours import Pixels, responses
from fakes.render.optics.canvas import Image, Patch
from fakes.render.optics.lattice import Window
from fakes.render.optics.lens import View
from fakes.render.optics.sensor import blurred
from fakes.world.connector.drawing import Colour


@dataclass(frozen=True, slots=True, eq=False)
class ColouredPatch:
    """A patch in shades of one colour; its grey is that of a white object."""

    patch: Patch
    colour: Colour


@dataclass(frozen=True, slots=True, eq=False)
class Canvas:
    """One image for each channel of the camera, before noise."""

    channels: tuple[Image, ...]
    response: Image

    @classmethod
    def filled(cls, view: View, pixels: Pixels, level: float) -> Self:
        """An even ground."""
        width, height = view.size_px
        response = responses(pixels)
        images = (np.full((height, width), level, dtype=np.float32) for _ in response)
        return cls(tuple(images), response)

    def paint(self, window: Window, cover: Image, shade: Image | float, colour: Colour) -> None:
        """Lay a surface over the picture; ``cover`` is its share of every pixel of the window."""
        tone = cover * np.float32(shade)
        for image, weight in zip(
            self.channels, self.response @ np.array(colour, dtype=np.float32), strict=True
        ):
            part = image[window.slices]
            part *= 1 - cover
            part += weight * tone

    def lit_and_blurred(self, light: Image, sigma_px: float) -> "Canvas":
        """The picture in uneven light and through the lens."""
        images = tuple(blurred(image * light, sigma_px) for image in self.channels)
        return replace(self, channels=images)

    def lay_over(self, item: ColouredPatch, light: Image) -> None:
        """A patch that brings its own blur."""
        weights = self.response @ np.array(item.colour, dtype=np.float32)
        for image, weight in zip(self.channels, weights, strict=True):
            replace(item.patch, grey=item.patch.grey * weight).lay_over(image, light)
