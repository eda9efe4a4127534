"""The kinds of holes that a feature file may name."""

from collections.abc import Iterator, Mapping, Sequence

from cellctl.vision.features.countersink import Countersink
from cellctl.vision.features.disc import Disc
from cellctl.vision.features.hole import Hole
from cellctl.vision.features.hole_kind import HoleKind
from cellctl.vision.features.pin import Pin
from cellctl.vision.features.thread import Thread

KINDS: Mapping[str, HoleKind] = {
    kind.name: kind for kind in (Pin(), Thread(), Countersink(), Disc())
}


def kind_of(hole: Hole) -> HoleKind:
    """The kind of a hole; ``KeyError`` for a name that is none."""
    return KINDS[hole.kind]


def by_brightness(holes: Sequence[Hole]) -> Iterator[tuple[bool, list[Hole]]]:
    """Dark holes, then bright ones, as far as there are any: each is searched for by itself."""
    # The search votes along the gradient, which points the other way at the rim of a bright
    # feature.
    for bright in (False, True):
        group = [hole for hole in holes if kind_of(hole).bright == bright]
        if group:
            yield bright, group
