"""Separation of bodies: arrangements of solids, gaps along normals, screening, FCL, and the proof over intervals."""
