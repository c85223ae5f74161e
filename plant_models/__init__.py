"""What stands under and on the seat: the two-mass seat with its friction, and the shaker."""
