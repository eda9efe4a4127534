"""A printed or retro-reflecting round target: a bright disc on a darker ground."""

from cellctl.vision.features.hole_kind import HoleKind


class Disc(HoleKind):
    """A flat bright disc."""

    name = "disc"
    bright = True
    may_show_wall = False
