"""Expands xacro, with arguments, by the package of that name."""

# xacro is optional and has no type stubs.
# pyright: reportMissingImports=false

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr
from io import StringIO
from pathlib import Path
from typing import Any

from artigen.errors import SourceError, name_options

SUFFIX = ".xacro"


def expand_xacro(path: Path, arguments: Sequence[str] = ()) -> str:
    """The URDF that a file stands for.

    ``$(find PACKAGE)`` is the folder of that name, or with a ``package.xml``, nearest above the file.

    Args:
        arguments: ``name:=value`` for each argument of the file.

    Raises:
        SourceError: If xacro is not installed, or the file cannot be expanded or has no such argument.
    """
    try:
        import xacro
    except ImportError as err:
        raise SourceError(f"{path}: xacro needs the package xacro: pip install 'artigen[xacro]'") from err
    given = _Asked(read_arguments(arguments))
    with _find_packages(path), redirect_stderr(StringIO()):
        try:
            document: Any = xacro.process_file(str(path), mappings=given)
            text = document.toxml()
        except (Exception, RecursionError) as err:  # whatever an expression in the file raises
            said = " ".join(str(err).split()) or type(err).__name__
            raise SourceError(f"{path}: xacro cannot expand it: {said:.300}") from err
    for name in set(read_arguments(arguments)) - given.asked:
        known = name_options(name, sorted(given.asked)) if given.asked else "none, as the file asks for none"
        raise SourceError(f"{path}: xacro argument {name!r}, expected {known}")
    return text


class _Asked(dict[str, str]):
    """Values of arguments, and the names that a file asks for; xacro adds those that have a default."""

    def __init__(self, values: Mapping[str, str]) -> None:
        super().__init__(values)
        self.asked: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.asked.add(name)
        return super().__getitem__(name)


def read_arguments(arguments: Sequence[str]) -> Mapping[str, str]:
    """Values by name of ``name:=value``.

    Raises:
        SourceError: If one is not of that form.
    """
    found = {}
    for said in arguments:
        name, between, value = said.partition(":=")
        if not name or not between:
            raise SourceError(f"xacro argument {said!r}, expected name:=value")
        found[name] = value
    return found


@contextmanager
def _find_packages(path: Path) -> Iterator[None]:
    """Looks ``$(find ...)`` up in the folders above a file, as ROS is not there."""
    from xacro import substitution_args

    def find(package: str) -> str:
        above = path.absolute().parents
        places = [place for folder in above for place in (folder, folder / package) if place.name == package]
        found = next((place for place in places if place.is_dir()), None)
        if found is None:
            raise substitution_args.SubstitutionException(
                f"package {package!r} is in no folder above the file"
            )
        return os.fspath(found)

    before = substitution_args._eval_find
    substitution_args._eval_find = find
    try:
        yield
    finally:
        substitution_args._eval_find = before
