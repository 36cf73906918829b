"""Recorded runs: the messages that cross borders, and writing and reading them as MCAP."""
