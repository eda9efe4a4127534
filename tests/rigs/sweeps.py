"""How much is tried: typical cases by `make test`, the rest by `make test-figures`, and for tests
that draw their examples ten times as many by `make test-explore`."""

from collections.abc import Collection, Iterable

import hypothesis
import pytest


def sweep(cases: Iterable[object], typical: Collection[object]) -> list[object]:
    """The cases for ``parametrize``; all but the typical ones are marked figures.

    A case of several arguments is a tuple of them.
    """
    marked = []
    for case in cases:
        values = case if isinstance(case, tuple) else (case,)
        marks = () if case in typical else (pytest.mark.figures,)
        marked.append(pytest.param(*values, marks=marks))
    return list[object](marked)


_EXAMPLES = 100
"""What Hypothesis draws where nobody says otherwise."""


def examples(number: int) -> int:
    """For ``max_examples``: so many, and in another profile as many times more as it draws."""
    profile = hypothesis.settings.get_profile(hypothesis.settings.get_current_profile_name())
    return number * profile.max_examples // _EXAMPLES
