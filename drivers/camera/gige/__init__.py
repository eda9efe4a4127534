"""GigE (and any other GenTL) cameras through harvesters and the producer of their maker.

The maker's library runs in a process of its own (``library_process``): when it hangs or crashes it
costs a fault and that process, never the daemon.
"""
