"""Commands that talk to one robot without the daemon, for whoever commissions it. None moves it."""
