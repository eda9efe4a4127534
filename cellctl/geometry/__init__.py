"""Poses, wrenches and their uncertainty: pure functions on arrays, SI units."""
