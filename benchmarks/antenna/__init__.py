"""Figures of the antenna module process: vision, chain of transforms, insertion."""
