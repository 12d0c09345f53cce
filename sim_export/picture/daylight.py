"""Pictures of rooms by daylight: the sky shines through windows, lamps are lit, and walls pass light on."""

# mitsuba has incomplete type stubs, and is optional.
# pyright: reportAttributeAccessIssue=false

from collections.abc import Collection, Sequence

import numpy as np
from jaxtyping import Float, UInt8

from artigen.camera import Camera
from artigen.splats.colors import srgb_from_linear
from sim_export.picture.raycast import Surface
from sim_export.picture.tracing import TraceConfig, trace

SKY, LAMP = 12.0, 9.0
"""Radiance of the sky, and of the lamps of a room together."""
BULB = 0.09
"""Radius (m) of a lamp."""
WARM = (1.0, 0.83, 0.62)
"""Linear colour of lamps."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Share of linear red, green and blue in luminance (ITU-R BT.709)."""
MIDDLE, WHITE = 0.42, 12.0
"""Luminance that the middle of all pixels gets, and the one that becomes white."""


def render_daylight(
    surfaces: Sequence[Surface],
    camera: Camera,
    sky: Collection[int],
    lamps: Sequence[Sequence[float]],
    cfg: TraceConfig | None = None,
) -> UInt8[np.ndarray, "H W 3"]:
    """A picture from within a room, sRGB, exposed for what it shows.

    Args:
        surfaces: The room (m) with everything in it, its walls and its ceiling.
        camera: A camera in the room.
        sky: Ids of the surfaces that are the sky behind windows.
        lamps: Places (m) of lit lamps.

    Raises:
        PackageError: If Mitsuba is not installed.
    """
    lights = {
        f"lamp_{number}": {
            "type": "sphere",
            "center": list(place),
            "radius": BULB,
            "light": {
                "type": "area",
                "radiance": {"type": "rgb", "value": [LAMP / len(lamps) * part for part in WARM]},
            },
        }
        for number, place in enumerate(lamps)
    }
    glow = dict.fromkeys(sky, SKY)
    return develop(trace(surfaces, camera, lights, cfg, glow=glow, pane="passes"))


def develop(image: Float[np.ndarray, "H W 3"]) -> UInt8[np.ndarray, "H W 3"]:
    """Linear radiance as sRGB: the median luminance becomes `MIDDLE`, and bright values are compressed so
    that `WHITE` is white (Reinhard et al. 2002, equation 4)."""
    luminance = image @ LUMINANCE
    exposure = MIDDLE / max(float(np.median(luminance)), 1e-9)
    level = np.maximum(exposure * luminance, 0.0)[..., None]
    shown = exposure * image * (1.0 + level / WHITE**2) / (1.0 + level)
    return np.rint(255.0 * srgb_from_linear(np.clip(shown, 0.0, 1.0))).astype(np.uint8)
