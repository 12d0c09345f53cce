"""Weights that come with artigen; what they were trained on and what they measure: docs/reports/model_card.md."""

from pathlib import Path

SHIPPED = Path(__file__).parent / "small"
"""Folder of the model of preset `small`."""
