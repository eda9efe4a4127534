"""A bore for a pin: a dark hole with a sharp or slightly broken edge."""

from cellctl.vision.features.hole_kind import HoleKind, RimEvidence, SecondEdge

_BROKEN_EDGE = SecondEdge(0.07, 0.05)
"""A broken edge of 0.2 mm at a bore of 6 mm, with a sigma that lets the image decide."""
_LEAST_GAIN = 25.0
"""Fall of chi square in both images together from which on a bore counts as deburred. Walls in
uneven light alone stay below it."""
_LEAST_GAIN_BESIDE_DENTS = 250.0
"""The same where arcs have left the fits: what a dent or a facet leaves of itself in its
neighbours reaches a hundred, a broken edge all round hundreds in each image."""


class Pin(HoleKind):
    """A bore, deburred or not."""

    name = "pin"

    def second_edge(self, evidence: RimEvidence) -> SecondEdge | None:
        """A broken edge a pixel or two wide, when both images together ask for it."""
        least = _LEAST_GAIN_BESIDE_DENTS if evidence.arcs_left_out() else _LEAST_GAIN
        return _BROKEN_EDGE if sum(evidence.ring_gains()) > least else None
