"""Which of the two poses of a station was meant otherwise, when they do not go together."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from cellctl.processes.deck_to_frame.recipe import DeckRecipe

_TURNS_DEG = (0.0, 90.0, -90.0, 180.0)
_POSES = ("base_T_frame", "flange_T_deck")


@dataclass(frozen=True, slots=True)
class MeantPose:
    """The key to be named, and what was probably meant."""

    name: str
    written: tuple[float, ...]
    said: str
    """``did you mean ...? `` or nothing."""


def meant_pose(recipe: DeckRecipe, fits: Callable[[DeckRecipe], bool]) -> MeantPose:
    """The pose that one slip of the pen explains; ``base_T_frame`` where both or none can be.

    ``fits`` says whether a recipe's station goes together. The slips: a sign, a factor of ten, a
    right angle.
    """
    meant = {name: _first_fitting(recipe, name, fits) for name in _POSES}
    found = [name for name, other in meant.items() if other is not None]
    name = found[0] if len(found) == 1 else _POSES[0]
    said = "; or ".join(
        f"did you mean {'' if one == name else f'{one} = '}{meant[one]}" for one in found
    )
    return MeantPose(name, getattr(recipe, name), f"{said}? " if said else "")


def _first_fitting(
    recipe: DeckRecipe, name: str, fits: Callable[[DeckRecipe], bool]
) -> list[float] | None:
    for other in _slips(getattr(recipe, name)):
        if fits(recipe.model_copy(update={name: tuple(other)})):
            return other
    return None


def _slips(written: Sequence[float]) -> Iterator[list[float]]:
    """The pose with one of its figures written otherwise."""
    for index, figure in enumerate(written):
        others = [-figure, figure * 10.0, figure / 10.0]
        if index >= 3:
            others = [-figure, *_TURNS_DEG]
        for other in others:
            if other != figure:
                yield [*written[:index], other, *written[index + 1 :]]
