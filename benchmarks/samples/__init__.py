"""Sample files for every command that works from files; `docs/samples.md` uses them.

    python -m benchmarks.samples --out config/samples

Drawn by the renderer of the fake cell and by the cases of the tests, with fixed seeds.
"""
