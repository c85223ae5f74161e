/* Reproducible random numbers, the C twin of random_numbers.py: number n of a seed follows from the seed and n alone.
 * No state, no globals. */
#ifndef RANDOM_NUMBERS_H
#define RANDOM_NUMBERS_H

#include <stdint.h>

/* Return stream `number` (from 0) of a seed. */
uint64_t random_stream(uint32_t seed, uint32_t number);

/* Return the 64 bits at an index of a stream; the index may be negative. */
uint64_t random_bits(uint64_t stream, int64_t index);

/* Return the normally distributed number at an index of a stream: mean 0, standard deviation 1. */
double random_normal(uint64_t stream, int64_t index);

#endif
