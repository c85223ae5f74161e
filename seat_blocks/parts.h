/* What the blocks share, the C twin of parts.py. */
#ifndef PARTS_H
#define PARTS_H

#include "sampling.h"
#include "seat.h"

#include <stddef.h>

/* Return where a part ends that begins `begin` seconds after the begin of the communication step: at the next multiple
 * of the interval, 0 for none, or with the step; in s after the begin of the step. */
static inline double end_of_part(double time, double begin, double step_size, double interval)
{
    if (interval == 0.0) {
        return step_size;
    }
    const double end = next_exchange(time + begin, interval) - time;
    return end < step_size - sample_tolerance * interval ? end : step_size;
}

/* Derive the coefficients of a block's seat; returns NULL, or a message. */
static inline const char *prepare_seat(const seat_plant_parameters *parameters, seat_plant_coefficients *coefficients)
{
    if (parameters->driver_model == SEAT_PLANT_EXTERNAL) {
        return "expected seat.driver.model lumped or seated, got external, for which a block has no port; SeatPlant "
               "has one";
    }
    return seat_plant_prepare(parameters, coefficients);
}

#endif
