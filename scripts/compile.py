"""Compiles ahead what the tests use most, so that two processes do not compile it at the same time.

    python -m scripts.compile kernel | laws

What is compiled is kept (`flocking.compilation`): where it is there already, this takes a second. The kernel of the
kinematic herd and all laws take about as long as each other, a minute or more, and know nothing of one another.
"""

from __future__ import annotations

import argparse
import importlib
from collections.abc import Callable

from flocking import lawentry, lawsource


def kernel() -> None:
    """The kinematic herd's inner loop, which is compiled as it is imported."""
    importlib.import_module("flocking.kinematic.kernel")


def laws() -> None:
    """Every law that comes with the project."""
    for name in lawsource.names():
        lawentry.load(name)


PARTS: dict[str, Callable[[], None]] = {"kernel": kernel, "laws": laws}


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("part", choices=PARTS)
    PARTS[parser.parse_args().part]()


if __name__ == "__main__":
    main()
