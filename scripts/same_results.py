"""Holds a restructured version of the project against the one before: the same commands, the same results, bit for bit.

    python -m scripts.same_results keep BEFORE      in the old version: runs every experiment, small, with two seeds
    python -m scripts.same_results keep AFTER       in the new version
    python -m scripts.same_results compare BEFORE AFTER

`keep` runs the `herd` command that is installed beside the Python which runs it, so that one copy of this file serves
any version. `compare` reads what those commands wrote: what `herd show` says (but for the words of sources), each row
of the results, each array of the series, and each column of one recording, with its scans. Equal bits are to be
expected on one type of processor only.
"""

from __future__ import annotations

import argparse
import io
import json
import re
import sqlite3
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

SMALLER: dict[str, tuple[str, ...]] = {"vicsek-transition": ("--set", "steps=100")}
"""Options of experiments that would take long at their own settings."""
SEEDS = (1, 2)
ADDED = "added:"
"""Before what only the new version has, which is told, and is no difference."""
NOT_COMPARED = frozenset({"trial", "format"})
"""Of a series' head: the trial as its version writes it down, and the version of the format."""
_COLUMN_GAP = re.compile(r"\s{2,}")


def herd(*words: str) -> str:
    """What the command prints; its lines on the way are left on stderr."""
    command = [str(Path(sys.executable).with_name("herd")), *words]
    ended = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if ended.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(words)}: exit code {ended.returncode}")
    return ended.stdout


def keep(folder: Path, experiments: list[str], seeds: list[int]) -> None:
    """Runs the experiments (all, if none is named) into `folder`."""
    names = experiments or [line.split()[0] for line in herd("list", "experiments").splitlines() if line]
    for name in names:
        own = folder / name
        own.mkdir(parents=True, exist_ok=True)
        (own / "show.txt").write_text(herd("show", name), encoding="utf-8")
        for seed in seeds:
            run = own / f"seed-{seed}"
            if not run.exists():
                options = ("--repeats", "1", "--seed", str(seed), "--record", "first", "--scans", "some")
                herd("run", name, "--out", str(run), *options, *SMALLER.get(name, ()))
            print(f"{name}, seed {seed}: kept", flush=True)


def compare(before: Path, after: Path) -> list[str]:
    """The differences, a line each."""
    found: list[str] = []
    for own in sorted(path for path in before.iterdir() if path.is_dir()):
        other = after / own.name
        if not other.is_dir():
            found.append(f"{own.name}: no such experiment in {after}")
            continue
        found += _unequal(f"{own.name}: herd show", _shown(own / "show.txt"), _shown(other / "show.txt"))
        for run in sorted(own.glob("seed-*")):
            where = f"{own.name}, {run.name}"
            found += _unequal(f"{where}: row", dict(_rows(run)), dict(_rows(other / run.name)))
            found += _unequal(f"{where}: series", _series(run), _series(other / run.name))
            found += _unequal(f"{where}: recording", _recordings(run), _recordings(other / run.name))
    return found


def _unequal(where: str, before: dict[Any, Any], after: dict[Any, Any]) -> list[str]:
    lines = [f"{ADDED} {where} {key}" for key in after.keys() - before.keys()]
    lines += [f"{where} {key}: gone" for key in before.keys() - after.keys()]
    for key in before.keys() & after.keys():
        if before[key] != after[key]:
            lines.append(f"{where} {key}: {before[key]!s:.200} became {after[key]!s:.200}")
    return sorted(lines)


def _shown(path: Path) -> dict[Any, Any]:
    """What `herd show` says by key: values, units, published or chosen; constants by their last name; all else as is.

    The words of sources, the last column, are left out.
    """
    found: dict[Any, Any] = {}
    kind = ""
    for line in path.read_text(encoding="utf-8").splitlines():
        cells = _COLUMN_GAP.split(line)
        if cells[0] in ("parameter", "constant, not to be set", "trial"):
            kind = cells[0]
        elif kind == "parameter" and len(cells) > 1:
            about = next((k for k, cell in enumerate(cells) if cell in ("published", "chosen")), len(cells) - 1)
            found[cells[0]] = cells[1 : about + 1]
        elif kind.startswith("constant") and len(cells) > 1 and not line.startswith("varied"):
            found[cells[0].rsplit(".", 1)[-1], cells[1]] = True
        elif line:
            found[line] = True
    return found


def _rows(run: Path) -> Iterator[tuple[int, tuple[Any, ...]]]:
    with sqlite3.connect(run / "results.sqlite") as tables:
        for row in tables.execute("SELECT idx, status, reason, seed, repeat, conditions, measures FROM trials"):
            yield row[0], tuple(row[1:])


def _series(run: Path) -> dict[Any, Any]:
    """Every array of every trial, as type, shape and bytes; and what else its file holds."""
    found: dict[Any, Any] = {}
    for path in sorted((run / "series").glob("*.npz")):
        with zipfile.ZipFile(path) as archive:
            for entry in archive.namelist():
                data = archive.read(entry)
                if not entry.endswith(".npy"):
                    head = json.loads(data)
                    found |= {(path.stem, entry, k): v for k, v in head.items() if k not in NOT_COMPARED}
                    continue
                array = np.lib.format.read_array(io.BytesIO(data), allow_pickle=False)
                found[path.stem, entry] = (array.dtype.str, array.shape, array.tobytes())
    return found


def _recordings(run: Path) -> dict[Any, Any]:
    """Every column of what was recorded, by entity; the trial in words is told by its version."""
    from rerun.chunk import RrdReader

    found: dict[Any, list[Any]] = {}
    for path in sorted((run / "recordings").glob("*.rrd")):
        for chunk in RrdReader(path).stream():
            if chunk.entity_path.strip("/") == "about":
                continue
            batch = chunk.to_record_batch()
            for name in batch.schema.names:
                if not name.endswith("row_id") and name not in ("rerun.controls.RowId", "log_time", "log_tick"):
                    found.setdefault((path.stem, chunk.entity_path, name), []).append(batch.column(name).to_pylist())
    return {key: repr(sorted(map(repr, columns))) for key, columns in found.items()}


def main() -> int:
    """The command: 0 the same, 1 differences; it prints them, and what was added."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    ways = parser.add_subparsers(dest="way", required=True)
    keeping = ways.add_parser("keep", help="run every experiment, small")
    keeping.add_argument("folder", type=Path)
    keeping.add_argument("--experiments", nargs="*", default=[])
    keeping.add_argument("--seeds", nargs="*", type=int, default=list(SEEDS))
    comparing = ways.add_parser("compare", help="hold what was kept by two versions side by side")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    given = parser.parse_args()
    if given.way == "keep":
        keep(given.folder, given.experiments, given.seeds)
        return 0
    differences = compare(given.before, given.after)
    print("\n".join(differences))
    changed = [line for line in differences if not line.startswith(ADDED)]
    print(f"{len(changed)} differences; {len(differences) - len(changed)} entries that only the new version has")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
