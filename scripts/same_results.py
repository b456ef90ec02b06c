"""Compares two versions of the project: whether the same commands give the same results, bit for bit.

    python -m scripts.same_results keep BEFORE      in the old version: runs every experiment, one repeat, two seeds
    python -m scripts.same_results keep AFTER       in the new version
    python -m scripts.same_results compare BEFORE AFTER
    python -m scripts.same_results sample FILE      writes the first moments of a few trials, with which a test compares

`keep` runs the `herd` command that is installed with the Python that runs this file, so that one copy of the file
serves any version. `compare` reads what those commands wrote: the lines of `herd show` (without the texts of sources),
each row of the results, each array of the series, and each column of one recording, with its scans. Equal bits can be
expected only on processors of the same type.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import platform
import re
import sqlite3
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

SMALLER: dict[str, tuple[str, ...]] = {"vicsek-transition": ("--set", "steps=100")}
"""Options of experiments that would take long at their own settings."""
SAMPLES: tuple[tuple[str, dict[str, Any], int], ...] = (
    ("detection-case-study", {"duration_s": 2.0}, 2),
    ("information-abstraction-robots", {"duration_s": 2.0}, 30),
    ("lch-table-4-1", {"steps": 10}, 1),
    ("couzin-leaders", {"steps": 20}, 5),
)
"""Experiment, settings and trial of each sample."""
SEEDS = (1, 2)
ADDED = "added:"
"""Begins a line on what only the new version has: it is printed, but is no difference."""
NOT_COMPARED = frozenset({"trial", "format"})
"""Parts of a series' head that depend on the version: how it writes the trial, and its format."""
_COLUMN_GAP = re.compile(r"\s{2,}")


def herd(*words: str) -> str:
    """Runs the command and returns what it prints on stdout."""
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
    if not before.is_dir() or not any(before.iterdir()):
        raise SystemExit(f"{before} holds no results: make them with keep")
    found = [f"{ADDED} {path.name}" for path in sorted(after.iterdir()) if not (before / path.name).exists()]
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


def sample() -> dict[str, Any]:
    """Measures of the first moments of a few trials, the hashes of their series, and what they were made with."""
    from trials.design import plan
    from trials.simulations import run_trial

    found: dict[str, Any] = {}
    for name, settings, index in SAMPLES:
        result = run_trial(plan(name, settings=settings).trials[index - 1])
        arrays: dict[str, Any] = {"times": result.times, "poses_w": result.poses_w, "odometry": result.odometry}
        arrays |= {"bumpers": result.bumpers, "contacts": result.contacts.points_w}
        arrays |= {f"updates.{key}": array for key, array in vars(result.updates).items()}
        hashes = {
            name: hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest() for name, array in arrays.items()
        }
        measures = {name: value for name, value in result.measures.items() if np.isfinite(value)}
        found[f"{name}, trial {index}"] = {"measures": measures, "hashes": hashes}
    return {"made with": made_with(), "trials": found}


def made_with() -> dict[str, str]:
    """What equal bits depend on: the processor's type and the versions of what computes."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    cpu = {line.partition(":")[2].strip() for line in lines if line.startswith("model name")}
    versions = {name: metadata.version(name) for name in ("mujoco", "numba", "numpy", "scipy")}
    return {"cpu": ", ".join(sorted(cpu)), "python": platform.python_version(), **versions}


def _unequal(where: str, before: dict[Any, Any], after: dict[Any, Any]) -> list[str]:
    lines = [f"{ADDED} {where} {key}" for key in after.keys() - before.keys()]
    lines += [f"{where} {key}: gone" for key in before.keys() - after.keys()]
    for key in before.keys() & after.keys():
        if before[key] != after[key]:
            lines.append(f"{where} {key}: {before[key]!s:.200} became {after[key]!s:.200}")
    return sorted(lines)


def _shown(path: Path) -> dict[Any, Any]:
    """The lines of `herd show`: of a key its value, unit, and whether published; of a constant its last name and value.

    The texts of sources, the last column, are left out.
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
    """Every array of every trial, as type, shape and bytes, and the other entries of its file."""
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
    """Every column of the recordings, by entity, without the trial in words, which depends on the version."""
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
    """The command: exit code 0 if the results are the same, 1 if not; prints the differences and what was added."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    ways = parser.add_subparsers(dest="way", required=True)
    keeping = ways.add_parser("keep", help="run every experiment, small")
    keeping.add_argument("folder", type=Path)
    keeping.add_argument("--experiments", nargs="*", default=[])
    keeping.add_argument("--seeds", nargs="*", type=int, default=list(SEEDS))
    comparing = ways.add_parser("compare", help="hold what was kept by two versions side by side")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    sampling = ways.add_parser("sample", help="the first moments of a few trials")
    sampling.add_argument("file", type=Path)
    given = parser.parse_args()
    if given.way == "sample":
        given.file.write_text(json.dumps(sample(), indent=1) + "\n", encoding="utf-8")
        return 0
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
