"""Holes and poses measured in rendered and drawn images, against exact truth."""
