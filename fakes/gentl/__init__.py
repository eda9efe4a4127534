"""Fake GigE cameras behind a real GenTL producer: a C library that any GenTL consumer loads.

``producer`` holds the library, ``build`` compiles it, ``cameras`` says what cameras there are and
what is wrong with them.
"""
