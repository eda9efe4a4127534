"""Rendered scenes for the measurement of holes, with exact truth."""
