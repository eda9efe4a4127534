"""Measuring frame and deck with both heads; the equations of the correction (paper 2.2, 2.3)."""
