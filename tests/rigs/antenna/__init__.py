"""Rendered connectors, an exact chain of poses and curves of insertions, with known truth."""
