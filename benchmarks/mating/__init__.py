"""Matings on simulated time: over stiffness, latency, failures and pins."""
