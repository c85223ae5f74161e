/* Flushing of subnormal numbers, the C twin of subnormal.py. */
#ifndef SUBNORMAL_H
#define SUBNORMAL_H

/* States of smaller magnitude are set to zero, in their own unit. */
#define MIN_STATE 1e-30

/* Return a state, or zero if its magnitude is below MIN_STATE. */
static inline double flush_subnormal(double state)
{
    return state > -MIN_STATE && state < MIN_STATE ? 0.0 : state;
}

#endif
