/* The road under the two axles, the C twin of road.py. Allocates memory and reads a file in road_prepare only. */
#ifndef ROAD_H
#define ROAD_H

#include "interface.h"
#include "recording.h"

#include <stdint.h>

/* Random road in the cell under an axle: number of the cell, -1 before the road; elevation at both ends in m. */
typedef struct {
    double cell;
    double begin, end;
} road_track;

typedef struct {
    int profile;
    double decay, gain;              /* factors on elevation and normal number of a cell, 1 and m */
    uint64_t stream;                 /* of random numbers */
    double fade;                     /* distance over which the road rises in m */
    double height, length, position; /* of the obstacle in m */
    recording_samples samples;       /* road from a file, otherwise empty */
    char message[1024];              /* what is wrong with the file */
} road_coefficients;

/* Derive the coefficients; they own the memory of a road from a file until they are released. Returns NULL, or a
 * message about the file; then there is nothing to release. */
const char *road_prepare(const truck_cab_parameters *parameters, road_coefficients *coefficients);

/* Free the memory of coefficients that are prepared or all zero. */
void road_release(road_coefficients *coefficients);

/* Return an axle on the flat before the road. */
road_track road_before(void);

/* Advance an axle to the cell at a distance from the begin of the road in m. */
void road_advance(road_track *track, double distance, const road_coefficients *coefficients);

/* Return the elevation of the road in m under an axle in its cell, at a distance from the begin of the road in m. */
double road_elevation(const road_track *track, double distance, const road_coefficients *coefficients);

/* Check that an axle can be in a cell where it has driven a distance in m, give or take a tolerance in m. */
int road_is_valid_track(const road_track *track, int profile, double distance, double tolerance);

#endif
