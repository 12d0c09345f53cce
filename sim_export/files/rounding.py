"""Numbers as JSON files hold them."""

import numpy as np


def rounded(values: object, decimals: int = 9) -> list:
    """A nested list of floats, rounded and without negative zeros."""
    return (np.round(np.asarray(values, np.float64), decimals) + 0.0).tolist()


def number(value: float, decimals: int = 9) -> float:
    """A rounded float without negative zero."""
    return round(float(value), decimals) + 0.0
