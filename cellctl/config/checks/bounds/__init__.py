"""Figures that have to keep bounds, and what takes part where one does not."""
