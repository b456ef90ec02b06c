"""The shape of a scan: segments, time warping, templates of members, and members recognised by them."""
