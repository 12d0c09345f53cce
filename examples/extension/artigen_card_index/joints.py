"""The export format ``joints_csv``: a table of joints."""

from pathlib import Path


def write_joints(package, folder, existing):
    """Writes ``FOLDER_joints.csv`` and returns it."""
    path = Path(folder).with_name(f"{Path(folder).name}_joints.csv")
    if path.exists() and existing == "refuse":
        raise FileExistsError(path)
    rows = [f"{joint.name},{joint.type},{joint.lower:.6g},{joint.upper:.6g}" for joint in package.joints]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(["name,type,lower,upper", *rows]) + "\n")
    return path
