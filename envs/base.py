"""Common base of the three environments: a package in its own scene, rebuilt at every reset."""

from pathlib import Path
from typing import Any, Literal

import gymnasium as gym
import numpy as np
from jaxtyping import Float

from sim_export.files.read import read_package
from sim_export.package import SimPackage

from .sim.loaded import LoadedPackage, collision_boxes
from .sim.sapien import LoadConfig, load_package
from .sim.scene import create_scene

CONTROL_FREQUENCY = 20
SUBSTEPS = 5
IMAGE_SIZE = 256


class PackageEnv(gym.Env):
    """A gymnasium environment around one package: 100 Hz physics, 20 Hz control, CPU only.

    Every reset rebuilds the scene (about 20 ms), so that an episode depends only on the seed and the actions.
    ``rgb_array`` rendering needs a Vulkan device.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": CONTROL_FREQUENCY}  # noqa: RUF012

    base: Literal["fixed", "free"] = "fixed"
    """``free`` lets the object stand on the ground."""

    def __init__(self, package: Path | str, render_mode: str | None) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"render_mode {render_mode!r}, expected None or 'rgb_array'")
        self.render_mode = render_mode
        self.folder = Path(package)
        self.package: SimPackage = read_package(self.folder)
        self._camera = None
        self.scene, self.loaded = self._build()

    def _build(self):
        draw = self.render_mode == "rgb_array"
        ground = self.base == "free"
        scene = create_scene(1.0 / (CONTROL_FREQUENCY * SUBSTEPS), ground=ground, render=draw)
        cfg = LoadConfig(base=self.base, visuals="all" if draw else "none")
        loaded = load_package(scene, self.folder, cfg, self.package)
        if draw:
            self._camera = scene.add_camera("view", IMAGE_SIZE, IMAGE_SIZE, 1.0, 0.01, 100.0)
        return scene, loaded

    def _rebuild(self, seed: int | None) -> None:
        """Seeds the generator and builds a fresh scene at rest."""
        super().reset(seed=seed)
        self.scene, self.loaded = self._build()

    def render(self) -> np.ndarray | None:  # type: ignore[override]
        """An RGB picture ``[256, 256, 3]`` from the front and above, or ``None`` without a render mode."""
        if self._camera is None:
            return None
        import sapien

        boxes = collision_boxes(self.loaded)
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        forward = np.array([0.75, 0.4, -0.5]) / np.linalg.norm([0.75, 0.4, -0.5])
        left = np.cross([0.0, 0.0, 1.0], forward)
        left /= np.linalg.norm(left)
        pose = np.eye(4, dtype=np.float32)
        pose[:3, :3] = np.stack([forward, left, np.cross(forward, left)], axis=1)
        pose[:3, 3] = (low + high) / 2 - 1.3 * np.linalg.norm(high - low) * forward
        self._camera.entity.set_pose(sapien.Pose(pose))
        self.scene.update_render()
        self._camera.take_picture()
        return (np.clip(self._camera.get_picture("Color")[..., :3], 0.0, 1.0) * 255).astype(np.uint8)

    def close(self) -> None:
        """Releases the scene."""
        self._camera = None


def open_fractions(loaded: LoadedPackage) -> Float[np.ndarray, "J"]:
    """Open fraction of each joint, 0 at the lower limit and 1 at the upper; for a joint without limits its
    angle as a share of a full turn, in [-0.5, 0.5)."""
    qpos = np.asarray(loaded.articulation.qpos, dtype=np.float64)
    values = [
        (qpos[joint.index] - joint.spec.lower) / max(joint.span, 1e-9)
        if joint.limited
        else (qpos[joint.index] / joint.span + 0.5) % 1.0 - 0.5
        for joint in loaded.joints
    ]
    return np.array(values, dtype=np.float32).reshape(len(loaded.joints))
