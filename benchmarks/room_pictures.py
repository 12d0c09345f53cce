"""Furnishes README's rooms anew and renders them from the corner that shows most.

    python benchmarks/room_pictures.py --out out/readme_rooms

The first seed of each kind of room is taken as it comes; nothing is picked. Objects stay in ``out``, so a run
that was stopped goes on.
"""

from pathlib import Path

import numpy as np
import tyro
from PIL import Image
from save_picture import save_picture

from artigen.api.scene import SceneSettings, furnish_room
from artigen.runtime.runner import choose_runner
from artigen.types import SceneKind

ROOMS: tuple[SceneKind, ...] = ("kitchen", "living_room", "bedroom", "hall")
WIDTH = 640
"""Width of one room in pixels."""
SETTINGS = SceneSettings(clutter="lived", ajar=0.2, contents=0.3)


def main(out: Path = Path("out/readme_rooms"), seed: int = 0, workers: int | None = None) -> int:
    """Writes ``rooms.png``, two rooms to a row, and a line for each room."""
    tiles = []
    for kind in ROOMS:
        made = furnish_room(kind, out / kind, seed, None, SETTINGS, runner=choose_runner("local", workers))
        print(made.describe())
        picture = Image.open(out / kind / "corner.png").convert("RGB")
        tiles.append(np.asarray(picture.resize((WIDTH, WIDTH * picture.height // picture.width))))
    rows = [np.hstack(tiles[start : start + 2]) for start in range(0, len(tiles), 2)]
    save_picture(np.vstack(rows), out / "rooms.png")
    return 0


if __name__ == "__main__":
    raise SystemExit(tyro.cli(main))
