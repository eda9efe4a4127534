"""Appearance of plates with holes, of boards and of prints."""
