"""`artigen scene`: furnishes a room or a flat from a kind and a seed."""

import sys
from pathlib import Path

import tyro

from artigen.api.photo_room import furnish_photographed
from artigen.api.scene import Pictures, SceneFormat, SceneSettings, furnish_room
from artigen.cli.arguments import Out, Workers
from artigen.errors import ArtigenError
from artigen.runtime.runner import choose_runner
from artigen.types import SceneKind

SETTINGS = SceneSettings()


def scene(
    kind: tyro.conf.Positional[SceneKind],
    out: Out,
    seed: int = 0,
    packages: Path | None = None,
    cfg: tyro.conf.OmitArgPrefixes[SceneSettings] = SETTINGS,
    image: Path | None = None,
    formats: tuple[SceneFormat, ...] = ("mjcf",),
    pictures: Pictures = "all",
    workers: Workers = None,
) -> int:
    """Furnish a room or flat in which every door and drawer opens; writes scene.json, scene.xml and pictures.

    Args:
        kind: Kind of room, or flat.
        out: Output folder for scene.json, scene.xml, scene.usda, room.png, entrance.png and corner.png
            (of a flat, two for each room) and plan.png.
        seed: Seed of everything that is not set.
        packages: Folder with packages, at any depth, that passed `artigen validate`; without it, objects are
            sampled and validated first, which takes minutes.
        cfg: Properties of the room.
        image: Photograph of a kitchen's wall from before it: its cabinets and appliances are built and stand
            along a wall as they were seen.
        formats: Files besides scene.json: mjcf is scene.xml for MuJoCo; usd is scene.usda and an asset per
            package.
        pictures: Pictures to render: all, all with those at eye level in daylight (needs Mitsuba 3, and
            minutes), the plan only, or none.
        workers: Worker processes that sample objects; default: one per available core.
    """
    runner = choose_runner("local", workers)
    if image is not None:
        if kind != "kitchen" or packages is not None:
            raise ArtigenError(
                f"{kind} of a photograph: expected a kitchen, of its own objects without --packages"
            )
        shown = furnish_photographed(image, out, seed, cfg, formats=formats, pictures=pictures, runner=runner)
        sys.stdout.write(shown.describe() + "\n")
        return 0
    made = furnish_room(kind, out, seed, packages, cfg, formats=formats, pictures=pictures, runner=runner)
    sys.stdout.write(made.describe() + "\n")
    return 0
