"""The shaker: the cabin floor's motion."""
