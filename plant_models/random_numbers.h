/* Random numbers that follow from seed and place alone: the twin of random_numbers.py. No state, no globals. */
#ifndef RANDOM_NUMBERS_H
#define RANDOM_NUMBERS_H

#include <stdint.h>

/* One of the streams of a seed, from 0. */
uint64_t random_stream(uint32_t seed, uint32_t number);

/* The 64 bits at a place of a stream, of either sign. */
uint64_t random_bits(uint64_t stream, int64_t index);

/* The normal number at a place of a stream: mean 0, standard deviation 1. */
double random_normal(uint64_t stream, int64_t index);

#endif
