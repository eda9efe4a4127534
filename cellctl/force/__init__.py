"""Force: what hangs on a force sensor (``gravity``) and how two parts meet (``contact``).

Pure functions on numbers and arrays; the guard measures, this package computes. It imports nothing
by itself, because the guard process uses one module of it and must stay small.
"""
