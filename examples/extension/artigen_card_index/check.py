"""ACME001: everything that slides comes out by at least a hand's width."""

from sim_export.checks.config import CheckConfig
from sim_export.checks.registry import CheckSpec, Finding, at_least
from sim_export.checks.subject import Subject

LEAST = 0.08


def has_slides(subject: Subject) -> str:
    """The reason why the check does not apply, or ""."""
    return "" if any(joint.type == "prismatic" for joint in subject.joints) else "nothing slides"


def check_travel(subject: Subject, cfg: CheckConfig) -> Finding:
    """Compares the shortest range of a sliding joint with a hand's width."""
    slides = [joint for joint in subject.joints if joint.type == "prismatic"]
    shortest = min(slides, key=lambda joint: joint.upper - joint.lower)
    travel = shortest.upper - shortest.lower
    message = f"joint {shortest.name!r} comes out {travel:.2f} m"
    return at_least(travel, LEAST, "m", where=shortest.name, message=message)


CHECK = CheckSpec(
    id="ACME001", level="L2", title="slides give way", applies=has_slides, function=check_travel
)
