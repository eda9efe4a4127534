"""``cellctl study``: one kind of trial of a recipe over thousands of seeds, on as many processors
as there are.

``kinds`` are the trials, ``results`` keeps one line a seed, ``farm`` gives seeds to Dask, ``table``
and ``chart`` show what came out.
"""
