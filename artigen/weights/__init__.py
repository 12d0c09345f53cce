"""Weights that come with artigen; what they were trained on and what they measure: docs/model_card.md."""

from pathlib import Path

STRUCTURE = Path(__file__).parent / "structure"
"""Folder of the structure model."""
