"""The truck: the motion of the cab floor of a two-axle heavy truck on a road."""
