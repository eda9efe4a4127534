"""Sweeps of which `make test` takes the typical cases, and `make test-figures` the rest."""

from collections.abc import Collection, Iterable

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
