"""A campaign of generated inputs against the command line: what it refuses, how, and at which cost."""
