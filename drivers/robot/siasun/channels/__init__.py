"""The daemon's two channels to the controller: commands with their streams, and the state.

The guard's own channel is ``stop_channel`` beside this folder, with blocking sockets.
"""
