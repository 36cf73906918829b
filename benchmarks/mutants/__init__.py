"""How many small faults in the product its tests notice: `python -m benchmarks.mutants`."""
