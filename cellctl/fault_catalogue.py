"""Every fault that this installation can report: those of cellctl and those of installed plug-ins.

The faults of a plug-in, process or driver, stand in the module ``faults`` of its package, beside
the module that its entry point names. They are found there without loading the plug-in itself, so
that a program that only shows faults (the operator page, a report, `cellctl faults`) loads neither
vision nor the library of a vendor.
"""

import logging
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from itertools import groupby

from cellctl import plugins
from cellctl.errors.base import CellError, catalogue

log = logging.getLogger(__name__)

FIRST_OF_PLUG_INS = 1000
"""Numbers below are those of cellctl and of what ships with it."""
_SHIPPED = ("cellctl", "drivers")


def known_faults() -> list[type[CellError]]:
    """By number: every fault of cellctl and of the installed plug-ins."""
    modules = (*_SHIPPED, *fault_modules())
    return [fault for fault in catalogue() if _within(fault, modules)]


def shipped_faults() -> list[type[CellError]]:
    """By number: the faults that come with cellctl, whatever else is installed."""
    return [fault for fault in known_faults() if _within(fault, _SHIPPED)]


def known_fault(number: int) -> type[CellError] | None:
    """The fault of this number; None if neither cellctl nor an installed plug-in has it."""
    fault_modules()
    # Also what a plug-in that keeps its faults elsewhere has loaded by now: better its own words
    # than none. Where two have one number, cellctl's own comes first.
    found = [fault for fault in catalogue() if fault.number == number]
    return min(found, key=lambda fault: not _within(fault, _SHIPPED), default=None)


def misnumbered() -> Iterator[tuple[int, str]]:
    """Numbers that no operator could rely on, and whose they are.

    One number of two faults, or a number of cellctl's range in a plug-in.
    """
    for number, same in groupby(known_faults(), key=lambda fault: fault.number):
        faults = list(same)
        names = " and ".join(sorted(f"{one.__module__}.{one.__name__}" for one in faults))
        if len(faults) > 1:
            yield number, f"a number of its own for each of {names}"
        elif number < FIRST_OF_PLUG_INS and not _within(faults[0], _SHIPPED):
            yield number, f"a number from {FIRST_OF_PLUG_INS} on for {names}"


@cache
def fault_modules() -> tuple[str, ...]:
    """Names of the ``faults`` modules of all plug-ins, each of them imported by now."""
    packages = {
        point.module.rpartition(".")[0]
        for group in plugins.WITH_FAULTS
        for point in plugins.installed(group)
        # Drivers that ship with cellctl report its own faults; modules of that name translate the
        # codes of their devices, and load what does.
        if not point.module.startswith("drivers.")
    }
    return tuple(f"{package}.faults" for package in sorted(packages) if _imported(package))


def _imported(package: str) -> bool:
    """Whether the package has a module ``faults``, which is imported."""
    if not package:
        return False
    try:
        import_module(f"{package}.faults")
    # A plug-in that is damaged must not keep the operator from reading everybody else's faults.
    except ImportError as error:
        if getattr(error, "name", None) != f"{package}.faults":
            log.warning("the faults of %s cannot be read: %s", package, error)
        return False
    return True


def _within(fault: type[CellError], modules: tuple[str, ...]) -> bool:
    return any(
        fault.__module__ == name or fault.__module__.startswith(f"{name}.") for name in modules
    )
