"""Accuracy of the calibrations over many seeds."""
