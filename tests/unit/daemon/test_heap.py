"""What a process holds after images have come and gone between objects that stay."""

import subprocess
import sys

import pytest

from cellctl.daemon.heap import LARGE_BYTES, give_back_large_blocks, give_back_small_blocks

LEFT_MB = """
import sys
from cellctl.daemon.heap import give_back_large_blocks
if sys.argv[1] == "fixed" and not give_back_large_blocks():
    sys.exit("no mallopt")
def resident_mb():
    pages = int(open("/proc/self/statm").read().split()[1])
    return pages * 4096 / 1e6
before_mb, stay = resident_mb(), []
bytearray(30_000_000)  # freed at once: from now on the allocator takes images for small blocks
for _ in range(20):
    image = bytearray(5_000_000)
    stay.append(bytearray(100_000))  # lies behind the image, and stays when that is let go
    del image
    image = bytearray(4_900_000)
    stay.append(bytearray(100_000))
    del image
images = [bytearray(5_000_000) for _ in range(20)]
stay.append(bytearray(100_000))
del images
print(resident_mb() - before_mb)
"""


def left_mb(how: str) -> float:
    ran = subprocess.run(
        [sys.executable, "-c", LEFT_MB, how], capture_output=True, text=True, check=True
    )
    return float(ran.stdout)


def test_images_that_are_let_go_leave_nothing_behind() -> None:
    if not give_back_large_blocks():
        pytest.skip("this C library has no mallopt")
    assert LARGE_BYTES < 5_000_000
    assert left_mb("fixed") < 15.0, "41 small objects of 0.1 MB, and what the interpreter takes"
    assert left_mb("as it comes") > 80.0, "else the test shows nothing"


BETWEEN_MB = """
import sys
from cellctl.daemon.heap import give_back_small_blocks
def resident_mb():
    pages = int(open("/proc/self/statm").read().split()[1])
    return pages * 4096 / 1e6
before_mb = resident_mb()
blocks = [bytearray(10_000) for _ in range(10_000)]
blocks = blocks[::20]  # 5 MB that stay, between 95 that go
if sys.argv[1] == "given back" and not give_back_small_blocks():
    sys.exit("no malloc_trim")
print(resident_mb() - before_mb)
"""


def between_mb(how: str) -> float:
    ran = subprocess.run(
        [sys.executable, "-c", BETWEEN_MB, how], capture_output=True, text=True, check=True
    )
    return float(ran.stdout)


def test_what_lay_between_small_objects_that_stay_is_given_back() -> None:
    if not give_back_small_blocks():
        pytest.skip("this C library has no malloc_trim")
    assert between_mb("given back") < 20.0, "500 blocks, each on up to four pages of its own"
    assert between_mb("as it comes") > 80.0, "else the test shows nothing"


HELD = """
import gc
from cellctl.daemon.heap import collect_what_comes, hold_collections
before = gc.get_freeze_count()  # Python 3.12 begins with some
collect_what_comes()
print(gc.isenabled(), gc.get_freeze_count() - before)
hold_collections()
print(gc.isenabled())
loaded = [[] for _ in range(1000)]
collect_what_comes()
print(gc.isenabled(), gc.get_freeze_count() > before + 1000)
"""


def test_searches_are_held_at_the_start_and_leave_out_what_it_loaded() -> None:
    ran = subprocess.run([sys.executable, "-c", HELD], capture_output=True, text=True, check=True)
    assert ran.stdout.splitlines() == ["True 0", "False", "True True"]
