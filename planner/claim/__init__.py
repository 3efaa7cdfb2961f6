"""The claim of a plan: the one numeric statement of what it promises, as flat tables."""
