"""Writes docs/reference/cli.md from the help texts: ``python docs/cli_reference.py``."""

import argparse
import inspect
import re
import warnings
from pathlib import Path

import tyro

from artigen.cli.main import COMMANDS, load_command
from artigen.weights import SHIPPED

PAGE = Path(__file__).parent / "reference" / "cli.md"
HEAD = """# Command line

<!-- Written by docs/cli_reference.py from the help texts. Edit these, then run the script. -->

`artigen COMMAND --help` prints the same text. `python -m artigen` is the same program.
Exit codes: 0 done, 1 something failed, 2 wrong usage.

**Shell completion**: `artigen --tyro-print-completion bash` (or `zsh`) prints a completion script for
all commands and options. For bash, store it once:

```bash
mkdir -p ~/.local/share/bash-completion/completions
artigen --tyro-print-completion bash > ~/.local/share/bash-completion/completions/artigen
```
"""
EXAMPLES = {
    "shape": """artigen shape StorageFurniture -n 1000 -o out/cabinets
artigen shape Table --counts drawer=3 --width 1.4 -o out/desks
artigen shape Oven -n 12 -o out/ovens --sheet out/ovens.png
artigen shape StorageFurniture --topology drawer=3 door=0 -n 64 -o out/drawers""",
    "generate": """artigen generate Dishwasher -n 4 -o out/generated
artigen generate --text "an oak cabinet with two black handles" -o out/from_text
artigen generate --image photo.png -o out/from_photo""",
    "read": """artigen read kitchen.jpg --picture boxes.png
artigen read kitchen.jpg --json --box 0.55 0.1 0.9 0.95
artigen read --text "a dresser with six drawers, 1,2 m wide" --json""",
    "convert": """artigen convert PATH/TO/partnet_mobility/* -o out/packages
artigen convert PATH/TO/45261 -o out/rebuilt --visual voxels
artigen convert MY_OBJECT.urdf -o out/packages --front=-y --category Microwave""",
    "validate": """artigen validate out/packages
artigen validate out/packages/45261 --task --engines mujoco,pybullet""",
    "preview": """artigen preview out/packages/45261 -o detail.png
artigen preview out/packages/* -o sheet.gif""",
    "render": "artigen render out/packages --states 5 --views 2 -o out/labelled",
    "view": "artigen view out/packages/45261",
    "export": """artigen export ASSET_FOLDER -o out/mine
artigen export out/packages/45261 --for robosuite usd -o out/45261""",
    "restyle": "artigen restyle out/cabinet -n 8 -o out/looks",
    "grasps": """artigen grasps out/packages
artigen grasps out/packages --gripper franka robotiq_2f85 parallel:0.06 --out out/grasps""",
    "usd": "artigen usd out/packages -o out/usd",
    "sets": "artigen sets out/packages --least 8",
    "scene": """artigen scene kitchen --seed 3 --packages out/packages -o out/kitchen
artigen scene flat --rooms 5 -o out/flat""",
    "scenes": "artigen scenes kitchen bedroom --count 1000 --packages out/packages -o out/scenes",
    "dataset": """artigen dataset examples/household.yaml -o out/household
artigen dataset verify out/household --prove 20""",
    "demos": """artigen demos ArtiGen-OpenPart-v1 out/packages -n 100 -o out/demos
artigen demos ArtiGen-PutInside-v1 out/packages -n 50 -o out/put --format maniskill""",
    "train": "artigen train sketch RUN --preset small --minutes 120 --shards 10",
    "eval": "artigen eval sketch --model RUN/model -o RUN/evaluation",
    "demo": "artigen demo -o out/demo",
}
"""What one would type, by command."""


def render() -> str:
    """The page."""
    assert EXAMPLES.keys() == COMMANDS.keys()
    return HEAD + "".join(_section(name, EXAMPLES[name]) for name in COMMANDS)


def _section(name: str, example: str) -> str:
    command = load_command(name)
    about = str(inspect.getdoc(command)).split("\nArgs:")[0].strip()
    about = re.sub("^``", "- `", about, flags=re.MULTILINE).replace("``", "`")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # tyro has no other list of options
        actions = tyro.extras.get_parser(command)._actions
    shown = [action for action in actions if "--help" not in action.option_strings]
    rows = [_row(action) for action in sorted(shown, key=lambda action: bool(action.option_strings))]
    table = "\n".join(["| argument | value | default | |", "|---|---|---|---|", *rows])
    return f"\n## {name}\n\n{about}\n\n```bash\n{example}\n```\n\n{table}\n"


def _row(action: argparse.Action) -> str:
    """An argument as a row; its default stands at the end of its help."""
    text = " ".join(str(action.help).replace(str(SHIPPED), "the shipped model").split())
    found = re.fullmatch(r"(.*?)(?: \((?:default: (.*)|(required))\))?", text)
    assert found
    default = found[3] or (found[2] or "").strip().removeprefix("None").removeprefix("''")
    value = re.sub(r"\{None\}\||[\[\]{}]", "", str(action.metavar or "")).split(" ")[0].replace(",", ", ")
    names = sorted(action.option_strings, key=len) or [action.dest.replace("_", "-")]
    cells = (", ".join(f"`{name}`" for name in names), value, default, found[1].replace("``", "`"))
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    PAGE.write_text(render())
