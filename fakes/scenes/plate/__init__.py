"""The simplest scene: plates with holes and printed boards that lie somewhere, nothing to touch.

All of it is in the scenario file, so a small fake cell needs no code.
"""
