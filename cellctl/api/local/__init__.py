"""The local API: operators at the cell's PC command the daemon through a Unix-domain socket."""
