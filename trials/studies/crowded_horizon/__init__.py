"""Fine 2015, chapter 4: the four variations of local crowded horizon (LCH), in a kinematic herd and on Creates."""
