"""What `import assur` gives: calls, answers as objects, and clients of the service. `src/assur` names it.

Importing a module of this package loads no compiler, no native library and no pydantic: calls load what they need.
"""
