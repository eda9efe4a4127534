"""Holds what a good part feels like at its seat against itself, in a recipe and in a task alike."""

from collections.abc import Iterator

from cellctl.config.checks.bounds.bound import Bound
from cellctl.config.issue import ConfigIssue
from cellctl.processes.peg_in_hole.recipe import Seat

SIGMAS = 20.0
"""A force that is compared with thresholds of a few standard deviations lies well above them."""


def seat_order_issues(seat: Seat, where: str) -> Iterator[ConfigIssue]:
    """Limits between which no force lies; ``where`` is the key of the seat."""
    if not seat.least_n < seat.most_n:
        found = f"{seat.least_n:g}, {seat.most_n:g}"
        yield ConfigIssue(where, found, "least_n < most_n")


def seat_bounds(seat: Seat, force_sigma_n: float, where: str) -> Iterator[Bound]:
    """Forces that are only noise, and a pull that a seated part would not hold."""
    least_n = SIGMAS * force_sigma_n
    why = f"{SIGMAS:g} force_sigma_n: a seat that is only noise is none"
    yield Bound(f"{where}.least_n", seat.least_n, why, least=least_n)
    if seat.pull_n is not None:
        why = "pull_n, which the seated part must hold, so going in takes more"
        yield Bound(f"{where}.least_n", seat.least_n, why, least=seat.pull_n)
        why = f"{SIGMAS:g} force_sigma_n: a pull of less proves nothing"
        yield Bound(f"{where}.pull_n", seat.pull_n, why, least=least_n)
