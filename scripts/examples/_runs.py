"""The runs (result files) of the paths on the command line: name and open file, one after another."""
import pathlib
import sys

import h5py


def runs():
    for path in map(pathlib.Path, sys.argv[1:]):
        for file in sorted(path.glob("*.h5")) if path.is_dir() else [path]:
            with h5py.File(file) as f:
                yield file.stem, f
