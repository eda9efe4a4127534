"""Electrical connectors: their drawings, parts as they were made, and what is seen of them."""
