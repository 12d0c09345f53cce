"""One object in many looks in MuJoCo, from memory: geometry, masses and joints stay the same.

You will see the materials of the first fronts, and how long a model in another look takes.
"""

import time

import mujoco

import artigen
from sim_export.files.write import package_files


def main(count: int = 4) -> None:
    """Draws a cabinet and compiles it in ``count`` looks."""
    cabinet = artigen.sample("StorageFurniture", seed=3)
    front = next(v.name for link in cabinet.package.links for v in link.visuals if v.finish == "front")
    masses, seen = [], set()
    for seed in range(count):
        start = time.perf_counter()
        files = package_files(artigen.restyle(cabinet, seed).package)
        model = mujoco.MjModel.from_xml_string(files["mobility.mjcf.xml"].decode(), files)
        material = int(model.geom(front).matid[0])
        name = model.material(material).name
        rough, metal = model.mat_roughness[material], model.mat_metallic[material]
        print(f"{name}: roughness {rough:.2f}, metallic {metal:.0f}; {time.perf_counter() - start:.2f} s")
        masses.append(model.body_mass.tolist())
        seen.add(name)
    assert all(one == masses[0] for one in masses)
    assert len(seen) > 1


if __name__ == "__main__":
    main()
