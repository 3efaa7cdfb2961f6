"""Limits of joints from recorded motion: S-curves behind a servo's lag are fitted to the moves between rests."""
