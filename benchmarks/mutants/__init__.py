"""Measurement of the share of small faults that the tests notice: `python -m benchmarks.mutants`."""
