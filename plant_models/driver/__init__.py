"""The driver: a seated body of four masses above the seat."""
