"""Result files of the paths on the command line."""
import pathlib
import sys


def files():
    paths = [pathlib.Path(p) for p in sys.argv[1:]]
    return [f for p in paths for f in (sorted(p.glob("*.h5")) if p.is_dir() else [p])]
