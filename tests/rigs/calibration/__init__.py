"""What calibrations are made from, drawn from a known truth with noise."""
