"""One object in many looks in OpenUSD: each is a small layer over the first, as replicators of Isaac use it.

You will see what the finishes are in every layer. Needs usd-core: pip install "artigen[usd]".
"""

import tempfile
from pathlib import Path

import numpy as np

import artigen
from artigen.splats.colors import linear_from_srgb
from sim_export.appearance.dress import find_looks


def main(folder: Path, count: int = 3) -> None:
    """Writes a cabinet into ``folder`` and ``count`` layers that give its plain materials other colours."""
    from pxr import Gf, Usd, UsdShade

    cabinet = artigen.sample("StorageFurniture", seed=2)
    cabinet.export(folder / "cabinet", formats=("package", "usd"))
    (main_file,) = (folder / "cabinet_usd").rglob("*.usd")
    finish = {v.look: v.finish for link in cabinet.package.links for v in link.visuals}
    seen = set()
    for seed in range(count):
        worn = artigen.restyle(cabinet, seed)
        assert worn.shape is not None
        looks = find_looks(dict(worn.shape.finishes))
        stage = Usd.Stage.CreateNew(str(main_file.with_name(f"look_{seed}.usda")))
        stage.GetRootLayer().subLayerPaths.append(f"./{main_file.name}")
        for prim in stage.Traverse():
            look = looks.get(finish.get(prim.GetName(), ""))
            surface = UsdShade.Shader(prim.GetChild("surface"))
            if not prim.IsA(UsdShade.Material) or look is None or not surface:
                continue
            color = Gf.Vec3f(*linear_from_srgb(np.array(look.color)).tolist())
            diffuse = surface.GetInput("diffuseColor")
            diffuse.DisconnectSource()
            diffuse.Set(color)
            surface.GetInput("roughness").Set(look.material.roughness)
            surface.GetInput("metallic").Set(look.material.metallic)
            print(f"{finish[prim.GetName()]}: {look.material.name} {[round(value, 2) for value in color]}")
            seen.add(tuple(color))
        stage.Save()
    assert len(seen) > 3


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(Path(scratch))
