"""The picture under construction, and the patches that are laid over it from far to near."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fakes.render.lattice import Window
from fakes.render.lens import Array

Image = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Patch:
    """What a small object does to the picture below it: ``below * through + grey``."""

    window: Window
    through: Array
    """Part of each pixel in which the picture below stays visible."""
    grey: Array
    """Grey that the object adds, already weighted with its part of the pixel."""

    def lay_over(self, image: Image) -> None:
        """Change ``image`` in place."""
        part = image[self.window.slices]
        part *= self.through.astype(np.float32)
        part += self.grey.astype(np.float32)
