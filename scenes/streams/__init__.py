"""Streams of parts: what comes on the conveyors of a cell, and when; from the cell file and a seed."""
