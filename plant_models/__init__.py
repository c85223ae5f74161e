"""Models of the plant: the two-mass seat with friction, actuator and sensors, the shaker and the truck under it."""
