"""From a goal and a belief to the next action: denotation, belief regression, the plan stack."""
