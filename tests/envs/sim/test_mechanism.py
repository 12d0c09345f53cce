"""Followers and springs as values: where they belong, and which cannot be."""

from typing import Any

import numpy as np
import pytest
import torch

from artigen.types import Joint
from envs.sim.mechanism import find_mechanism
from sim_export.errors import PackageError
from sim_export.package import SimPackage


def joint(name: str, **given: Any) -> Joint:
    return Joint(
        name=name, type="prismatic", parent="body", child=f"link of {name}",
        origin=np.zeros(3), axis=np.array([1.0, 0.0, 0.0]), upper=1.0, **given,
    )  # fmt: skip


def package_of(*joints: Joint) -> SimPackage:
    return SimPackage(name="a", category="Table", visual="voxels", links=(), joints=joints)


CHAIN = package_of(
    joint("last", follows="middle", ratio=3.0, offset=0.1),
    joint("first"),
    joint("middle", follows="first", ratio=-2.0, offset=0.5),
)


@pytest.mark.parametrize("names", [("last", "first", "middle"), ("first", "middle", "last")])
@pytest.mark.parametrize("kind", [np.array, torch.tensor])
def test_followers_of_followers_are_where_the_first_leader_puts_them(names: tuple[str, ...], kind):
    """In any order of the engine's joints, for one vector and for many, arrays and tensors."""
    first = np.array([0.0, 0.2, 1.0])
    wanted = {"first": first, "middle": 0.5 - 2.0 * first, "last": 0.1 + 3.0 * (0.5 - 2.0 * first)}
    given = kind(np.stack([first if name == "first" else np.full(3, 9.0) for name in names], axis=1))
    mechanism = find_mechanism(CHAIN, names)
    found = mechanism.complete(given)
    np.testing.assert_allclose(found, np.stack([wanted[name] for name in names], axis=1), atol=1e-12)
    np.testing.assert_allclose(mechanism.complete(given[1]), found[1])
    assert float(given[0][names.index("last")]) == 9.0


def test_a_follower_needs_a_leader_that_moves_by_itself():
    with pytest.raises(PackageError, match="'lid' follows 'pedal', which does not move"):
        find_mechanism(package_of(joint("lid", follows="pedal"), joint("pedal")), ["lid"])
    with pytest.raises(PackageError, match="which follows it"):
        find_mechanism(package_of(joint("a", follows="b"), joint("b", follows="a")), ["a", "b"])


def test_only_joints_with_springs_pull_and_held_ones_do_not():
    package = package_of(joint("a", spring=1.0), joint("b"), joint("c", spring=-2.0))
    names = ["c", "b", "a"]
    assert [(x.spec.name, x.column) for x in find_mechanism(package, names).springs] == [("c", 0), ("a", 2)]
    assert [x.spec.name for x in find_mechanism(package, names, held=["a"]).springs] == ["c"]
    assert not find_mechanism(package, names, held=["a", "c"])
