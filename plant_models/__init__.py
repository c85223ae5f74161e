"""Models of the plant: the two-mass seat with friction, actuator and sensors, and the shaker that moves the floor."""
