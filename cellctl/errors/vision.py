"""4xx: images, holes and part poses."""

from cellctl.errors.base import CellError


class VisionError(CellError):
    """A measurement could not be made or trusted."""
