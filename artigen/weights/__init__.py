"""The shipped weights, described in docs/reports/model_card.md."""

from pathlib import Path

SHIPPED = Path(__file__).parent / "small"
"""Folder of the model of preset `small`."""
READER = Path(__file__).parent / "reader"
"""Folder of the reader of photographs."""
