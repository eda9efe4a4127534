"""How far a figure may go towards a value that is not allowed, by bisection.

A root finder of scipy has no place here: what is asked answers yes or no, and to load it takes
longer than the rest of a check.
"""

from collections.abc import Callable


def farthest_allowed(
    allowed: float, refused: float, is_allowed: Callable[[float], bool], *, within: float
) -> float:
    """The allowed value nearest to one that is refused, to ``within``, and itself allowed.

    ``is_allowed`` changes once between the two, of which either may be the greater one; ``within``
    is above the resolution of floating-point numbers there.
    """
    while abs(refused - allowed) > within:
        middle = (allowed + refused) / 2.0
        if is_allowed(middle):
            allowed = middle
        else:
            refused = middle
    return allowed
