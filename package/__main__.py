"""`python -m skolem`: the command `skolem` of this Python's environment, wherever its script lies."""

from skolem.tools.cli import main

if __name__ == "__main__":  # processes that a sweep starts load this file too
    raise SystemExit(main())
