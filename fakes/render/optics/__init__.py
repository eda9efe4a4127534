"""Turns surfaces into grey levels: lens, pixel lattice, area coverage, light, blur and noise."""
