"""Keep a resin of your own: a whole resin file, or measured points that update a known one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from dummydesign.core.datafiles import Entry, read_toml, user_folder
from dummydesign.core.errors import InputError
from dummydesign.core.files import output_folder
from dummydesign.core.own_files import make_room
from dummydesign.resin.model.resin import Resin
from dummydesign.resin.model.resin_file import KIND, load_resin, read_points, read_resin
from dummydesign.resin.model.resin_writer import save_resin


def add_resin(file: str | Path, replace_own: bool = False) -> tuple[Resin, Path]:
    """Check a file and keep the resin it describes in the user's own folder.

    A file with ``[modulus]`` is a whole resin; one with ``[[point]]`` and without ``[modulus]`` updates
    its ``base`` (the paper's polyurethane when none is named).

    Parameters
    ----------
    file : path
        TOML file.
    replace_own : bool
        Take the place of a resin of the user with this name.

    Returns
    -------
    resin : Resin
    path : Path
        Where it was kept.

    Raises
    ------
    InputError
        When the file or its name is not usable, the name is taken, or the folder cannot be written.
    """
    path = Path(file)
    if not path.is_file():
        raise InputError(f"resin file '{file}' does not exist")
    if path.suffix.lower() == ".csv":
        raise InputError(
            f"resin file '{file}' is a CSV, not TOML: give each point as [[point]] with ratio and young_kPa "
            "(value, low, high, kind, source); of a puck's trace 'dummydesign resins add-compression' makes the point"
        )
    content, _ = read_toml(path)
    if "modulus" in content or "point" not in content:
        resin = replace(read_resin(Entry(path.stem, path, "user")), origin="user")
    else:
        from dummydesign.resin.update.modulus import Point, update_resin

        base, name, points = read_points(path)
        resin = update_resin(load_resin(base), [Point(ratio, young) for ratio, young in points], name)
    make_room(KIND, "resin", resin.name, replace_own)
    folder = output_folder(user_folder() / KIND)
    return resin, save_resin(resin, folder / f"{resin.name}.toml")
