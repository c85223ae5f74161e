"""The seat as one block for a vehicle: active, passive and semi-active, with the same ports."""
