"""The picture under construction, and the patches that are laid over it."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from fakes.render.optics.lattice import Window
from fakes.render.optics.lens import Array
from fakes.render.optics.sensor import REACH, Image, blurred_cells

__all__ = ["Image", "Patch", "margin_px"]


def margin_px(blur_px: float) -> int:
    """Distance that a blurred object reaches beyond its outline."""
    return 3 + int(np.ceil(REACH * blur_px))


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """The effect of a small object on the picture below it: ``below * through + grey``."""

    window: Window
    through: Array | Image
    """Part of each pixel in which the picture below stays visible."""
    grey: Array | float = 0.0
    """Grey that the object adds, already weighted with its part of the pixel."""

    @classmethod
    def from_cells(cls, window: Window, through: Array, grey: Array, blur_px: float) -> Self:
        """Patch from values of the window's cells, through blur and pixel box."""
        # Blurred in cells and averaged to pixels afterwards: the other way round the sampled kernel
        # would depend on where in a pixel an edge lies.
        sigma = blur_px * window.sub
        return cls(
            window,
            window.mean(blurred_cells(through, sigma)),
            window.mean(blurred_cells(grey, sigma)),
        )

    @classmethod
    def of_one_grey(cls, window: Window, outside: Array, grey: float, blur_px: float) -> Self:
        """Does what ``from_cells`` does for an object of one grey: one blur serves both arrays."""
        through = window.mean(blurred_cells(outside, blur_px * window.sub))
        return cls(window, through, (1 - through) * grey)

    def lay_over(self, image: Image, light: Image | None = None) -> None:
        """Change ``image`` in place; ``light`` falls on the object's own grey."""
        part = image[self.window.slices]
        part *= self.through
        part += self.grey if light is None else self.grey * light[self.window.slices]
