"""Layers before drivers that may hang: the core waits for none of them for ever."""
