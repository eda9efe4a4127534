"""A countersunk bore: the rim that carries the centre is the lower edge of a cone."""

import numpy as np

from cellctl.vision.features.hole_kind import HoleKind, RimEvidence, SecondEdge

_NARROW_PX = 5.0
"""Both edges of a cone narrower than this blur into each other and must be fitted together."""
_UNSEEN = SecondEdge(0.15, 0.08)
"""Width when neither drawing nor image tells it, but the fit asks for a second edge."""
_STATED_SHARE, _SEEN_SHARE = 0.1, 0.2
"""Standard deviation of the width over itself when the drawing states it and when the image shows
it."""


class Countersink(HoleKind):
    """A bore under a cone."""

    name = "countersink"
    cone = True

    def second_edge(self, evidence: RimEvidence) -> SecondEdge | None:
        """The outer edge of the cone, when it is so near that it disturbs the rim."""
        narrow = any(clear_px < _NARROW_PX for clear_px in evidence.clear_px)
        if not (narrow or evidence.ring_seen()):
            return None
        # The drawing is preferred to the image. Without a stated diameter the width is infinite,
        # and the image decides.
        stated = (evidence.hole.countersink_m or np.inf) / evidence.hole.diameter_m - 1.0
        if stated < evidence.in_radii(_NARROW_PX):
            return SecondEdge(stated, _STATED_SHARE * stated)
        widths = [
            evidence.in_radii(clear_px, image)
            for image, clear_px in enumerate(evidence.clear_px)
            if np.isfinite(clear_px)
        ]
        if not widths:
            # Narrow, but by the score test alone: neither the drawing nor an edge tells how wide it
            # is.
            return _UNSEEN
        seen = float(np.mean(widths))
        return SecondEdge(seen, _SEEN_SHARE * seen)
