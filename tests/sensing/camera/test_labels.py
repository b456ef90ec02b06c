"""Labelled images: what was written is what was there."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flocking.errors import InputError
from sensing.camera.labels import Labelled, annotations_of, coco, decoded, encoded


def plain_decoding(lengths) -> np.ndarray:
    """COCO's run lengths by their definition, a pixel at a time, in plain Python."""
    height, width = lengths["size"]
    mask, at, value = np.zeros((height, width), bool), 0, False
    for count in lengths["counts"]:
        for _ in range(count):
            mask[at % height, at // height] = value
            at += 1
        value = not value
    assert at == height * width
    return mask


@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 10**6), st.sampled_from([0.0, 0.3, 0.7, 1.0]))
def test_run_lengths_give_the_mask_back(height, width, seed, density):
    mask = np.random.default_rng(seed).random((height, width)) < density
    lengths = json.loads(json.dumps(encoded(mask)))
    np.testing.assert_array_equal(plain_decoding(lengths), mask)
    np.testing.assert_array_equal(decoded(lengths), mask)
    assert all(count > 0 for count in lengths["counts"][1:])


def picture(seed: int, name: str = "a.png") -> Labelled:
    rng = np.random.default_rng(seed)
    robots = rng.integers(-1, 4, (6, 9))
    cones = np.where(rng.random((6, 9)) < 0.5, robots, -1)
    return Labelled(name, 2, "left", 0.5, cones, robots, rng.normal(size=(4, 2)), rng.normal(size=(4, 2)))


def test_a_set_of_images_is_json_with_all_that_was_seen():
    pictures = [
        picture(1),
        picture(2, "b.png"),
        picture(3)._replace(cones=np.full((6, 9), -1), robots=np.full((6, 9), -1)),
    ]
    made = json.loads(json.dumps(coco(pictures, "test")))
    assert [i["id"] for i in made["images"]] == [1, 2, 3]
    assert [a["id"] for a in made["annotations"]] == list(range(1, len(made["annotations"]) + 1))
    assert {c["id"]: c["name"] for c in made["categories"]} == {1: "cone", 2: "robot"}
    assert not [a for a in made["annotations"] if a["image_id"] == 3]
    for number, each in enumerate(pictures, start=1):
        for category, owners, at in ((1, each.cones, each.cones_at), (2, each.robots, each.robots_at)):
            mine = [a for a in made["annotations"] if a["image_id"] == number and a["category_id"] == category]
            again = np.full(owners.shape, -1)
            for a in mine:
                mask = plain_decoding(a["segmentation"])
                again[mask] = a["robot"]
                assert a["area"] == mask.sum()
                x, y, width, height = a["bbox"]
                assert mask[y : y + height, x : x + width].sum() == a["area"]
                assert mask[y].any()
                assert mask[y + height - 1].any()
                assert mask[:, x].any()
                assert mask[:, x + width - 1].any()
                assert (a["bearing_rad"], a["distance_m"]) == tuple(at[a["robot"]])
            np.testing.assert_array_equal(again, owners)


def test_what_does_not_fit_is_refused_in_one_line():
    good = picture(1)
    with pytest.raises(InputError, match="expected one \\(H, W\\)"):
        annotations_of(good._replace(cones=good.cones[:3]))
    with pytest.raises(InputError, match="below 2"):
        annotations_of(good._replace(robots_at=good.robots_at[:2]))
    with pytest.raises(InputError, match="expected 6 x 9"):
        decoded({"size": [6, 9], "counts": [3, 4]})
