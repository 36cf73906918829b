"""Options of both `replay` and `reproduce`: the tolerance of floats, and which divergences are printed."""

from typing import Annotated

import typer

Atol = Annotated[float | None, typer.Option(min=0.0, help="Absolute tolerance of floats. Default: by machine.")]
Rtol = Annotated[float | None, typer.Option(min=0.0, help="Relative tolerance of floats. Default: by machine.")]
All = Annotated[bool, typer.Option("--all", help="Print every divergence, not only the first.")]
