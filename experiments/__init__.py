"""Experiments: claims of the source papers, reproduced as figures and numbers."""
