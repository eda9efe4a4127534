"""Benchmarks of offline planning."""
