"""Joint moves with parabolic blends (source 004): acceleration jumps, via points are missed by a stated amount."""
