"""The verb `run`. May import: loop, recorded, words."""
