/* Subnormal numbers; explained in subnormal.py. */
#ifndef SUBNORMAL_H
#define SUBNORMAL_H

#define SMALLEST_STATE 1e-30

/* A state, or zero where its magnitude is below SMALLEST_STATE. */
static inline double flush_subnormal(double state)
{
    return state > -SMALLEST_STATE && state < SMALLEST_STATE ? 0.0 : state;
}

#endif
