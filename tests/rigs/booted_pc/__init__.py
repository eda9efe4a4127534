"""A PC that boots: the systemd of this machine as the first process of namespaces of its own."""
