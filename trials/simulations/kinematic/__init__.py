"""The compiled herd of `flocking.kinematic`: thousands of members without bodies, one law or many."""
