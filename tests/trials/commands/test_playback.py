"""What is played, and how the viewer is called. No viewer and no server is started here."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlparse

import pytest

from flocking.errors import InputError
from trials.batch.asked import ranges
from trials.commands import playback


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run's folder with the recordings of trials 2, 3, 4 and 9."""
    (tmp_path / "recordings").mkdir()
    for trial in (2, 3, 4, 9):
        (tmp_path / "recordings" / f"{trial:04d}.rrd").touch()
    (tmp_path / "recordings" / "notes.rrd").touch()
    return tmp_path


def test_the_first_recorded_trial_is_the_default(run: Path) -> None:
    assert playback.recording(run, None) == run / "recordings" / "0002.rrd"
    assert playback.recording(run, 9) == run / "recordings" / "0009.rrd"


def test_a_trial_that_was_not_recorded_names_those_that_were(run: Path) -> None:
    with pytest.raises(InputError, match=r"trial 5 .* was not recorded; recorded: 2-4, 9$") as told:
        playback.recording(run, 5)
    assert "\n" not in str(told.value)


def test_a_run_without_recordings_says_how_to_get_them(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--record"):
        playback.recording(tmp_path, None)
    with pytest.raises(InputError, match="no folder"):
        playback.recording(tmp_path / "missing", None)


def test_without_a_folder_the_newest_run_plays(run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trials.batch.folders.newest", lambda: run)
    assert playback.recording(None, 3) == run / "recordings" / "0003.rrd"


@pytest.mark.parametrize(("numbers", "text"), [([], ""), ([7], "7"), ([3, 1, 2], "1-3"), ([1, 3, 4, 9], "1, 3-4, 9")])
def test_numbers_in_short(numbers: list[int], text: str) -> None:
    assert ranges(numbers, ", ") == text


@pytest.mark.parametrize("web_port", [None, 9001])
def test_every_server_listens_on_the_loopback_address(tmp_path: Path, web_port: int | None) -> None:
    command = playback.viewer_command(tmp_path / "0001.rrd", 9000, web_port)
    assert command[command.index("--bind") + 1] == "127.0.0.1"
    assert ("--serve-web" in command) == (web_port is not None)
    assert str(tmp_path / "0001.rrd") in command


def test_the_web_address_leads_to_the_recording() -> None:
    address = urlparse(playback.web_address(9000, 9001))
    assert address.netloc == "127.0.0.1:9001"
    assert parse_qs(address.query)["url"] == ["rerun+http://127.0.0.1:9000/proxy"]


@pytest.mark.parametrize(("display", "web", "served"), [("", False, True), (":0", False, False), (":0", True, True)])
def test_the_web_viewer_stands_in_where_there_is_no_display(
    run: Path, monkeypatch: pytest.MonkeyPatch, display: str, web: bool, served: bool
) -> None:
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("DISPLAY", display)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    called: list[Any] = []
    monkeypatch.setattr(playback, "_serve", lambda path: called.append(("served", path.name)))
    monkeypatch.setattr(playback, "_show", lambda path: called.append(("shown", path.name)))
    playback.play(run, None, web)
    assert called == [("served" if served else "shown", "0002.rrd")]


def test_the_viewer_sends_no_statistics(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[str, Any] = {}
    monkeypatch.setattr("subprocess.Popen", lambda command, env, **how: seen.update(env))
    playback._started(["rerun"])
    assert seen["CI"]
