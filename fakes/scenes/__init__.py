"""Scenes: what stands in a fake cell, beyond its devices.

A scene is a world (``fakes.world.world.World``) with bodies in it: it says what a camera sees, what
a force sensor feels, which targets a tracker finds, what the hands of an operator can do, and what
the truth is at the end. The scenario file names it by its entry point in the group ``fakes.scene``,
so another package can bring its own.
"""
