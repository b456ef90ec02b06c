"""A pair of cameras that looks at one cone: how far away it takes it to be, and how often it sees it."""
