"""Memory of the daemon: modules stay loaded, and what a run leaves free goes back to the system."""

import ctypes
import gc

LARGE_BYTES = 2**20
"""Blocks of this size and more come from the system one by one and go back whole. An image is 5 MB;
to have its pages mapped anew costs a millisecond, which nothing waits for."""

_M_MMAP_THRESHOLD = -3  # malloc.h of the GNU C library


def give_back_large_blocks() -> bool:
    """Have the allocator keep no large block that was freed; False where it offers no such choice.

    The GNU C library raises the size from which it asks the system each time with every large block
    that is freed, up to 32 MB. From then on images lie among small objects that stay, and one such
    object above a freed image keeps its pages. Resident after each of five parts on the fake cell:
    286, 278, 369, 344 and 345 MB; with a fixed size 211, 220, 223, 225 and 223 MB.
    """
    allocator = ctypes.CDLL(None)
    if not hasattr(allocator, "mallopt"):
        return False
    return bool(allocator.mallopt(_M_MMAP_THRESHOLD, LARGE_BYTES))


def give_back_small_blocks() -> bool:
    """Give the pages back on which nothing lives any more; False where the allocator cannot.

    Nothing that a run makes is kept, but its small objects lie between those that stay, and by
    itself the GNU C library gives back only what lies above all of them: the daemon grew by 0.35 MB
    a part. No other thread gets memory meanwhile: 24 ms for 270 MB, less than one millisecond for
    what a part leaves. So this is for moments in which no robot moves.
    """
    allocator = ctypes.CDLL(None)
    if not hasattr(allocator, "malloc_trim"):
        return False
    allocator.malloc_trim(0)
    return True


def hold_collections() -> None:
    """Collect no garbage while the daemon is being loaded: there is hardly any, and the collections
    take a tenth of the start."""
    gc.disable()


def collect_what_comes() -> None:
    """Collect again, but leave out what exists already; nothing unless collections were held.

    Modules, their classes and the cell's configuration stay as long as the daemon does. Each full
    collection would go through all of them, while the event loop stands.
    """
    if not gc.isenabled():
        gc.freeze()
        gc.enable()
