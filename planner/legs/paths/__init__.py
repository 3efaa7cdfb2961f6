"""Legs along paths: traces at a process speed, and Cartesian legs along lines, arcs and splines."""
