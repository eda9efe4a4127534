"""Campaigns and benchmarks: figures as distributions, against the truth and against baselines."""
