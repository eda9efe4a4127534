"""Which pose of a station is wrong by a slip of the pen, where other values decide it."""

from collections.abc import Callable, Iterator, Sequence

from cellctl.processes.deck_to_frame.recipe import DeckRecipe

STATION_POSES = ("base_T_frame", "flange_T_deck")
_QUARTERS_DEG = (90.0, -90.0, 180.0)


def meant_pose(
    recipe: DeckRecipe, fits: Callable[[DeckRecipe], bool]
) -> tuple[str, list[float]] | None:
    """The pose that one slip of the pen explains, and how it was meant; None where both poses may
    be wrong, or no slip explains it.

    ``fits`` says whether a recipe agrees with two values that do not follow from each other. The
    slips: a sign, a factor of ten, a quarter or half of a turn.
    """
    found = [
        (name, other)
        for name in STATION_POSES
        for other in _slips(getattr(recipe, name))
        if fits(recipe.model_copy(update={name: tuple(other)}))
    ]
    return found[0] if len(found) == 1 else None


def _slips(written: Sequence[float]) -> Iterator[list[float]]:
    """The pose with one of its figures written otherwise, each once."""
    for index, figure in enumerate(written):
        others = {-figure, figure * 10.0, figure / 10.0} - {figure}
        if index >= 3:
            turned = {_within_a_turn(figure + quarter) for quarter in _QUARTERS_DEG}
            others = {-figure, *turned} - {figure}
        for other in sorted(others):
            yield [*written[:index], other, *written[index + 1 :]]


def _within_a_turn(angle_deg: float) -> float:
    """The same direction as an angle above -180 and up to 180 degrees."""
    turned = angle_deg % 360.0
    return turned - 360.0 if turned > 180.0 else turned
