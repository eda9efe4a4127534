"""Commands to the running daemon; they load nothing that computes."""
