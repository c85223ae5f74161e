"""The seat: two masses on a suspension, Bouc-Wen friction, actuator, sensors, end stops."""
