"""Matings on simulated time: physics of the fake cell, monitor of the guard, in one process."""
