"""Random requests of many kinds, in SI: a kind and a seed make the same request on every machine."""
