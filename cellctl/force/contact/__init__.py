"""Bringing two parts into contact under a force limit: speeds, steps, compliance and the verdict.

Pure functions on numbers and arrays. ``touch_detector`` uses plain floats only, because the guard
process imports it and must load no arrays; for the same reason this package imports none of its
modules.
"""
