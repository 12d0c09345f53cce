"""The directions of import, who may load what, and what the packages promise to export."""

import ast
import importlib
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from project import ROOT

PACKAGES = ("artigen", "sim_export", "envs")
SHARED = {
    "brief",
    "types",
    "transforms",
    "camera",
    "kinematics",
    "io",
    "errors",
    "kind",
    "plugins",
    "files",
    "runtime",
    "shapes",
    "splats",
}
"""Modules of artigen that the other two packages may use."""
MODEL_CODE = (
    "artigen.appearance",
    "artigen.conditioning",
    "artigen.examples",
    "artigen.models",
    "artigen.latent",
    "artigen.metrics",
    "artigen.reader.assemble",
    "artigen.reader.decode",
    "artigen.reader.kind_network",
    "artigen.reader.model",
    "artigen.reader.network",
    "artigen.reader.read",
    "artigen.reader.targets",
    "artigen.reader.trunk",
    "artigen.reader.wall",
    "artigen.shapes.render",
    "artigen.sketch",
    "artigen.train",
    "artigen.trellis",
    "envs.maniskill",
    "artigen.splats.render",
)
"""The only places where torch is imported."""
LAYERS = (
    {"brief", "errors", "types", "plugins", "kind", "transforms", "kinematics", "camera", "io", "weights"},
    {"files", "runtime"},
    {"voxels"},
    {"shapes"},
    {"kinds"},
    {"splats", "datasets", "conditioning"},
    {"models"},
    {"reader"},
    {"sketch"},
    {"latent"},
    {"appearance"},
    {"trellis", "examples"},
    {"metrics"},
    {"train"},
    {"api"},
    {"cli"},
)
"""Folders and loose modules of artigen, lowest first: a layer imports from itself and from below."""
EXPORT_LAYERS = (
    {"errors", "package", "report"},
    {"geometry"},
    {"motion", "topology"},
    {"physics"},
    {"collision", "appearance", "grasps"},
    {"files", "fingerprint"},
    {"picture"},
    {"checks"},
    {"search", "source_faults", "usd"},
    {"mend"},
    {"solids"},
    {"export", "reference"},
)
"""The same of sim_export."""
COMPOSING = ("artigen.api", "artigen.cli")
"""The only places that join the three packages."""
HEAVY = (
    "torch",
    "transformers",
    "sapien",
    "mujoco",
    "viser",
    "xatlas",
    "embreex",
    "trimesh",
    "mani_skill",
    "pxr",
    "yourdfpy",
)
"""Modules that nothing loads before it needs them."""


@dataclass(frozen=True, kw_only=True)
class Import:
    """One import statement: where it stands, the module it names, and the names it takes from it."""

    importer: str
    line: int
    module: str
    names: tuple[str, ...]
    at_load: bool

    def __str__(self) -> str:
        return f"{self.importer}:{self.line} imports {self.module} ({', '.join(self.names)})"


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _runs_at_load(tree: ast.Module) -> set[ast.AST]:
    """Import statements that run when the module is loaded: outside functions and type checking."""
    found: set[ast.AST] = set()
    waiting: list[ast.AST] = list(tree.body)
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Import | ast.ImportFrom):
            found.add(node)
        elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            waiting += node.orelse
        elif not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            waiting += ast.iter_child_nodes(node)
    return found


def imports_of(path: Path) -> list[Import]:
    importer = module_name(path)
    package = importer.split(".") if path.name == "__init__.py" else importer.split(".")[:-1]
    tree = ast.parse(path.read_text())
    at_load = _runs_at_load(tree)
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                found.append((node, alias.name, ()))
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            found.append((node, module, tuple(alias.name for alias in node.names)))
    return [
        Import(importer=importer, line=node.lineno, module=module, names=names, at_load=node in at_load)
        for node, module, names in found
    ]


SOURCES = {module_name(path): path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))}


@cache
def all_imports() -> list[Import]:
    return [item for path in SOURCES.values() for item in imports_of(path)]


def test_imports_are_read_as_python_reads_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path)
    source = tmp_path / "sim_export" / "checks" / "one.py"
    source.parent.mkdir(parents=True)
    source.write_text(
        "import torch.nn\nfrom ..package import Mesh\nfrom . import two\n"
        "if TYPE_CHECKING:\n    import viser\ndef f():\n    from envs.base import x, y\n"
    )
    read = {(item.module, item.names, item.at_load) for item in imports_of(source)}
    assert read == {
        ("torch.nn", (), True),
        ("sim_export.package", ("Mesh",), True),
        ("sim_export.checks", ("two",), True),
        ("viser", (), False),
        ("envs.base", ("x", "y"), False),
    }


def is_within(module: str, *packages: str) -> bool:
    return any(module == package or module.startswith(package + ".") for package in packages)


def test_the_walk_sees_the_code():
    assert len(SOURCES) > 60
    assert all(any(item.importer.split(".")[0] == package for item in all_imports()) for package in PACKAGES)
    assert any(
        item.importer == "sim_export.package" and item.module == "artigen.types" for item in all_imports()
    )
    assert any(item.module == "embreex" and not item.at_load for item in all_imports())


def test_imports_go_from_envs_to_sim_export_to_the_shared_part_of_artigen():
    wrong = []
    for item in all_imports():
        source, target = item.importer.split(".")[0], item.module.split(".")[0]
        if target not in PACKAGES or source == target or is_within(item.importer, *COMPOSING):
            continue
        if PACKAGES.index(target) > PACKAGES.index(source):
            wrong.append(str(item))
        elif target == "artigen":
            parts = item.module.split(".")[1:2] or item.names
            wrong += [str(item) for part in parts if part not in SHARED | {"__version__"}]
    assert not wrong


@pytest.mark.parametrize(("package", "layers"), [("artigen", LAYERS), ("sim_export", EXPORT_LAYERS)])
def test_a_package_is_a_stack_of_layers(package: str, layers: tuple[set[str], ...]):
    floor = {name: number for number, names in enumerate(layers) for name in names}
    wrong = []
    for item in all_imports():
        if not item.importer.startswith(f"{package}.") or item.module.split(".")[0] != package:
            continue
        source = item.importer.split(".")[1]
        if source == "__main__":
            continue
        targets = item.module.split(".")[1:2] or [name for name in item.names if name != "__version__"]
        wrong += [str(item) for target in targets if floor[target] > floor[source]]
    assert wrong == []


def test_only_the_api_and_the_command_line_compose_and_only_when_they_run():
    composing = [item for item in all_imports() if is_within(item.importer, *COMPOSING)]
    assert any(is_within(item.module, "sim_export") for item in composing)
    early = [str(item) for item in composing if item.at_load and is_within(item.module, "sim_export", "envs")]
    assert not early


def test_nothing_but_the_command_line_and_its_tests_import_the_command_line():
    """Whoever writes Python uses the API."""
    folders = (ROOT / "tests", ROOT / "benchmarks", ROOT / "examples")
    own = ROOT / "tests" / "artigen" / "cli"
    outside = [path for folder in folders for path in sorted(folder.rglob("*.py")) if own not in path.parents]
    users = [*all_imports(), *(item for path in outside for item in imports_of(path))]
    assert len(outside) > 200
    assert [
        str(item)
        for item in users
        if is_within(item.module, "artigen.cli") or (item.module == "artigen" and "cli" in item.names)
        if not is_within(item.importer, "artigen.cli", "artigen.__main__")
    ] == []


def test_torch_is_imported_by_model_code_only():
    assert [
        str(item)
        for item in all_imports()
        if is_within(item.module, "torch") and not is_within(item.importer, *MODEL_CODE)
    ] == []


def test_heavy_modules_are_imported_where_they_are_used():
    early = [
        str(item)
        for item in all_imports()
        if item.at_load
        and is_within(item.module, *HEAVY)
        and is_within(item.importer, "artigen", "sim_export")
        if not is_within(item.importer, *MODEL_CODE)
    ]
    assert early == []


def test_private_names_stay_in_their_module():
    wrong = [
        str(item)
        for item in all_imports()
        if item.module.split(".")[0] in PACKAGES
        for name in (*item.names, *item.module.split("."))
        if name.startswith("_") and not name.startswith("__")
    ]
    assert wrong == []


def test_modules_load_in_an_order_without_cycles():
    graph: dict[str, set[str]] = {name: set() for name in SOURCES}
    for item in all_imports():
        if not item.at_load:
            continue
        targets = {f"{item.module}.{name}" for name in item.names} & SOURCES.keys()
        if item.module in SOURCES and (not targets or SOURCES[item.module].name != "__init__.py"):
            targets.add(item.module)
        graph[item.importer] |= targets - {item.importer}
    order = list(TopologicalSorter(graph).static_order())
    assert order.index("artigen.types") < order.index("sim_export.package") < order.index("envs.sim.sapien")


def modules_to_load(package: str) -> list[str]:
    """What a fresh process imports: everything light of a package; of envs, the package itself."""
    if package == "envs":
        return ["envs"]
    return [
        name
        for name in SOURCES
        if is_within(name, package) and not is_within(name, *MODEL_CODE) and not name.endswith("__main__")
    ]


@pytest.mark.parametrize("package", PACKAGES)
def test_loading_a_package_loads_no_heavy_module(package: str):
    names = modules_to_load(package)
    code = (
        "import importlib, sys\n"
        f"for name in {names!r}: importlib.import_module(name)\n"
        f"print(*sorted({set(HEAVY)!r} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []


@pytest.mark.parametrize("package", PACKAGES)
def test_listed_names_are_sorted_few_and_there(package: str):
    module = importlib.import_module(package)
    assert module.__doc__
    listed = getattr(module, "__all__", [])
    assert list(listed) == sorted(listed)
    assert len(listed) <= 15
    assert all(hasattr(module, name) for name in listed)


def test_every_module_says_what_it_is():
    silent = [name for name, path in SOURCES.items() if not ast.get_docstring(ast.parse(path.read_text()))]
    assert silent == []
