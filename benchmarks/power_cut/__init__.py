"""What a power cut leaves of what the cell's records have acknowledged.

``python -m benchmarks.power_cut`` cuts the power of a real file system at random moments: an ext4
image on a loop device, shut down by the kernel's own request for this purpose, so that everything
that has not reached the image is gone. ``kill -9`` shows less: the kernel still writes what a
killed program has given it.
"""
