"""Rows of the proof: those of a certificate, about two bodies or about a body and a plane."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.model.outcome import Certificate


def rows_of(certificate: Certificate, number: dict[str, int]) -> FloatArray:
    """All rows, sorted by their times; where a row is against a plane its second body is -1. `number`: the claim's rows
    of bodies by name."""
    found = np.zeros((len(certificate), c.ROW))
    found[:, c.ROW_T0], found[:, c.ROW_T1] = certificate.t0, certificate.t1
    if certificate.shift0 is not None and certificate.shift1 is not None:
        # windows are sums of two numbers, which the rows have rounded
        for column, ahead, end in ((c.ROW_S0, certificate.shift0, -math.inf), (c.ROW_S1, certificate.shift1, math.inf)):
            found[:, column] = np.where(ahead != 0.0, np.nextafter(ahead, end), 0.0)
    at = np.array([*(number[name] for name in certificate.names), -1])
    found[:, c.ROW_BODY], found[:, c.ROW_BODY + 1] = at[certificate.first], at[certificate.second]
    found[:, c.ROW_PIECE], found[:, c.ROW_PIECE + 1] = certificate.first_piece, certificate.second_piece
    found[:, c.ROW_NORMAL :] = certificate.normal
    return found[np.lexsort((found[:, c.ROW_T1], found[:, c.ROW_T0]))]
