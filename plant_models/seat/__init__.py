"""The seat: two masses, friction, actuator, sensors, end stops."""
