"""A hole that is found and filled by touch, without arm, stream and forces in time."""
