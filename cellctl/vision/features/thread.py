"""A threaded hole: turns inside the rim, and mostly a chamfer round it."""

from cellctl.vision.features.hole_kind import HoleKind, RimEvidence, SecondEdge

_CHAMFER = SecondEdge(0.1, 0.05)
"""A chamfer of 0.25 mm at a thread M5, give or take half of that."""


class Thread(HoleKind):
    """A thread, chamfered or not."""

    name = "thread"
    turns = True
    # The face is judged from beyond the widest chamfer on.
    face_begins_radii = 1.15
    first_ring_px = 2.0
    # Turns that fade into the dark look like blur.
    lends_blur = False

    def second_edge(self, evidence: RimEvidence) -> SecondEdge | None:
        """A chamfer, as soon as an even dark disc does not explain the images.

        The fit with a chamfer also models the turns, so uneven turns ask for it just as well.
        """
        if not evidence.both_converged():
            return _CHAMFER
        return _CHAMFER if evidence.ring_seen() or evidence.uneven_inside() else None
