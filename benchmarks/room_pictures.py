"""Furnishes README's rooms anew, renders them by daylight from the corner that shows most, and a flat from
above.

    python benchmarks/room_pictures.py --out out/readme_rooms

The first seed of each kind of room is taken as it comes; nothing is picked. Objects stay in ``out``, so a run
that was stopped goes on.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import tyro
from jaxtyping import UInt8
from PIL import Image
from save_picture import save_picture

from artigen.api.scene import SceneSettings, furnish_room
from artigen.runtime.runner import choose_runner
from artigen.types import SceneKind
from envs.rooms.picture import draw_daylight
from envs.rooms.room import Room
from envs.rooms.views import find_views

ROOMS: tuple[SceneKind, ...] = ("kitchen", "living_room", "bedroom", "hall")
WIDTH, FLAT_WIDTH = 640, 800
"""Width of one room, and of the flat, in pixels."""
SETTINGS = SceneSettings(clutter="lived", ajar=0.2, contents=0.3)


def draw_corner(room: Room) -> UInt8[np.ndarray, "H W 3"]:
    """The room from the corner that shows most."""
    view = next(view for view in find_views(room) if view.name == "corner")
    share = WIDTH / view.camera.width
    height = round(share * view.camera.height)
    camera = replace(view.camera, width=WIDTH, height=height, pixel=view.camera.pixel / share)
    return draw_daylight(room, replace(view, camera=camera))


def main(out: Path = Path("out/readme_rooms"), seed: int = 0, workers: int | None = None) -> int:
    """Writes ``rooms.jpg``, two rooms to a row, ``flat.jpg``, and a line for each room."""
    tiles = []
    for kind in ROOMS:
        runner = choose_runner("local", workers)
        made = furnish_room(kind, out / kind, seed, None, SETTINGS, pictures="none", runner=runner)
        print(made.describe())
        tiles.append(draw_corner(made.room))
    rows = [np.hstack(tiles[start : start + 2]) for start in range(0, len(tiles), 2)]
    save_picture(np.vstack(rows), out / "rooms.jpg")
    flat = SceneSettings(rooms=("3",))
    print(
        furnish_room(
            "flat", out / "flat", seed, None, flat, runner=choose_runner("local", workers)
        ).describe()
    )
    whole = Image.open(out / "flat" / "room.png").convert("RGB")
    small = whole.resize((FLAT_WIDTH, FLAT_WIDTH * whole.height // whole.width), Image.Resampling.LANCZOS)
    save_picture(np.asarray(small), out / "flat.jpg")
    return 0


if __name__ == "__main__":
    raise SystemExit(tyro.cli(main))
