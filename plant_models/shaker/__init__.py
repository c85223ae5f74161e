"""The shaker: the motion of the cabin floor."""
