/* When samples are due, and the rate of a measured signal, the C twin of sampling.py. Times in s. */
#ifndef SAMPLING_H
#define SAMPLING_H

#include "interface.h"

#include <math.h>

/* A sample is due if its time is reached within this share of the sample time: hosts accumulate rounding errors. */
static const double sample_tolerance = 1e-3;

/* Return the number of the first sample that is not before a time; sample k is due at k times the sample time. */
static inline double samples_before(double time, double sample_time)
{
    return ceil(time / sample_time - sample_tolerance);
}

/* Return the first multiple of an interval after a time. */
static inline double next_exchange(double time, double interval)
{
    return (floor(time / interval + sample_tolerance) + 1.0) * interval;
}

/* Derive the factors of the filtered rate v_k = (tau v_(k-1) + delta_k - delta_(k-1)) / (tau + h), tau = 1/(2 pi f_c):
 * tau/(tau + h) and 1/(tau + h) in 1/s. */
static inline void rate_filter(seat_controller_real cutoff, seat_controller_real sample_time,
                               seat_controller_real *decay, seat_controller_real *gain)
{
    const seat_controller_real one = (seat_controller_real)1.0;
    const seat_controller_real tau = one / ((seat_controller_real)(2.0 * 3.14159265358979323846) * cutoff);
    *decay = tau / (tau + sample_time);
    *gain = one / (tau + sample_time);
}

/* Return v_k from v_(k-1), delta_(k-1) and delta_k. */
static inline seat_controller_real filtered_rate(seat_controller_real rate, seat_controller_real before,
                                                 seat_controller_real value, seat_controller_real decay,
                                                 seat_controller_real gain)
{
    return decay * rate + gain * (value - before);
}

#endif
