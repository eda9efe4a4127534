"""Pictures with exact sub-pixel geometry: lens, area coverage, blur, noise, eight bits.

``api`` is the entrance for tests and benchmarks, ``worker`` that of the fake cameras.
"""
