"""Kinematic trials: herds of `flocking.kinematic` as experiments, without MuJoCo, robots or sensors."""
