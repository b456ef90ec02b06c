"""Schemas of trials: the product's are read once, a user's own file each time."""

from __future__ import annotations

from pathlib import Path

import pytest

from flocking.errors import InputError
from generation import found
from trials.simulations.schemas import schema_of
from trials.types import Trial


def trial(world: str) -> Trial:
    return Trial("made-up", 1, "environments", world, "square", ())


def test_a_grammar_of_the_products_is_read_once() -> None:
    assert schema_of(trial("splitting")) is schema_of(trial("splitting"))


def test_a_users_own_file_is_read_as_it_is_now(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    text = (found.FOLDER / "splitting.toml").read_text()
    mine.write_text(text)
    before = schema_of(trial(str(mine)))
    mine.write_text(text.replace(before.about, "Another"))
    assert schema_of(trial(str(mine))).about == "Another" != before.about


def test_a_schema_that_there_is_not_is_named_with_the_nearest() -> None:
    with pytest.raises(InputError, match="unknown world 'spliting'; did you mean splitting"):
        schema_of(trial("spliting"))
