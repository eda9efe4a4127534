"""Guides whose files are written out and tried, as a reader would."""
