"""The iRobot Create (first generation): its model, drive command, controller, odometry and fleet."""
