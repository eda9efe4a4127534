"""From a surface to grey levels: lens, pixel lattice, area coverage, light, blur and noise."""
