"""Worlds, rigs and cases that tests and benchmarks share: what is there before anything is asked.

Both trees import from here. This package imports from neither, and neither imports the other but
for the tests of the benchmarks (``tests/unit/benchmarks``); ``tests/test_house_style.py`` holds it.
"""
