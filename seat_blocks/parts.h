/* The parts of a communication step between which a block's law and its seat exchange values, the C twin of parts.py.
 */
#ifndef PARTS_H
#define PARTS_H

#include "sampling.h"

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

#endif
