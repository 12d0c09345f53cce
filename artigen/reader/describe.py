"""A reading in words."""

from artigen.reader.reading import Reading, to_hex


def describe(reading: Reading) -> str:
    """A reading in a few lines."""
    likely = ", ".join(f"{kind} {share:.0%}" for kind, share in reading.kinds[:3])
    width, depth, height = reading.size
    lines = [f"{reading.kind} ({likely})"]
    if not reading.sure:
        lines[0] = f"not sure: {likely}"
    counts = ", ".join(
        f"{count} {label}{'s' * (count != 1)}" for label, count in reading.counts.items() if count
    )
    lines.append(f"in view: {counts or 'no doors, drawers, handles or knobs'}")
    for front in reading.fronts:
        left, top, right, bottom = front.box
        said = [front.label, f"{left:.2f} {top:.2f} {right:.2f} {bottom:.2f}"]
        said += [f"hinges {front.hinge}"] if front.hinge else []
        said += ["open"] if front.open else []
        said += ["glazed"] if front.pane else []
        said += [front.material] if front.material else []
        said += [to_hex(front.color)] if front.color else []
        lines.append("  " + ", ".join(said))
    lines.append(
        f"about {width:.2f} m wide, {depth:.2f} m deep, {height:.2f} m high, on {_name_stand(reading.stand)}"
    )
    lines += [f"note: {note}" for note in reading.notes]
    return "\n".join(lines) + "\n"


def _name_stand(stand: str) -> str:
    return {"flat": "its base", "legs": "legs", "wheels": "wheels"}[stand]
