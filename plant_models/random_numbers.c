/* splitmix64 and the polar method with a logarithm of its own; see random_numbers.py. */
#include "random_numbers.h"

#include <math.h>
#include <stddef.h>

/* Apply the output function of splitmix64. */
static uint64_t mix(uint64_t bits)
{
    bits = (bits ^ (bits >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    bits = (bits ^ (bits >> 27)) * UINT64_C(0x94D049BB133111EB);
    return bits ^ (bits >> 31);
}

uint64_t random_bits(uint64_t stream, int64_t index)
{
    return mix(stream + ((uint64_t)index + 1u) * UINT64_C(0x9E3779B97F4A7C15));
}

uint64_t random_stream(uint32_t seed, uint32_t number)
{
    return random_bits(random_bits(0, (int64_t)seed), (int64_t)number);
}

/* Return the natural logarithm of a positive number, accurate to a few units in the last place. */
static double logarithm(double x)
{
    static const double coefficients[] = {1.0 / 23.0, 1.0 / 21.0, 1.0 / 19.0, 1.0 / 17.0, 1.0 / 15.0, 1.0 / 13.0,
                                          1.0 / 11.0, 1.0 / 9.0,  1.0 / 7.0,  1.0 / 5.0,  1.0 / 3.0,  1.0};
    static const double ln_2 = 0.6931471805599453, sqrt_half = 0.7071067811865476;
    int exponent;
    double mantissa = frexp(x, &exponent);
    if (mantissa < sqrt_half) {
        mantissa *= 2.0;
        exponent -= 1;
    }
    const double z = (mantissa - 1.0) / (mantissa + 1.0); /* ln m = 2 artanh z */
    const double square = z * z;
    double series = 0.0;
    for (size_t i = 0; i < sizeof coefficients / sizeof *coefficients; ++i) {
        series = series * square + coefficients[i];
    }
    return (double)exponent * ln_2 + 2.0 * z * series;
}

double random_normal(uint64_t stream, int64_t index)
{
    uint64_t bits = random_bits(stream, index);
    for (;;) {
        const double u = ((double)(bits >> 32) + 0.5) * 0x1p-31 - 1.0;
        const double v = ((double)(bits & UINT32_MAX) + 0.5) * 0x1p-31 - 1.0;
        const double s = u * u + v * v;
        if (s < 1.0) {
            return u * sqrt(-2.0 * logarithm(s) / s);
        }
        bits = random_bits(bits, 0);
    }
}
