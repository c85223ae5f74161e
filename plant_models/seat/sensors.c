/* The sensors; see sensors.py for the method. */
#include "sensors.h"

#include "random_numbers.h"
#include "subnormal.h"

#include <math.h>

/* Hold time of the noise in s. */
static const double tick = 0.002;

/* Times closer than this, in s, are equal: communication points carry rounding errors. */
static const double time_tolerance = 1e-9;

/* Numbers of at least this magnitude have no fraction: 2^52. */
static const double min_integer = 4503599627370496.0;

sensor_coefficients sensor_prepare(double noise, double bias, double resolution, int seed, uint32_t number)
{
    const int ideal = noise == 0.0 && bias == 0.0 && resolution == 0.0;
    const sensor_coefficients c = {noise, bias, resolution, random_stream((uint32_t)seed, number), ideal};
    return c;
}

double sensor_add_errors(double value, const sensor_coefficients *c, double time)
{
    if (c->noise > 0.0) {
        value += c->noise * random_normal(c->stream, (int64_t)floor((time + time_tolerance) / tick));
    }
    if (c->bias != 0.0) {
        value += c->bias;
    }
    if (c->resolution > 0.0) {
        const double steps = value / c->resolution;
        if (fabs(steps) < min_integer) {
            value = c->resolution * floor(steps + 0.5);
        }
    }
    return value;
}

double sensor_low_pass(double filtered, double begin, double end, double angle)
{
    const double gain = -expm1(-angle);
    const double ratio = angle > 0.0 ? gain / angle : 1.0;
    return flush_subnormal(filtered + (begin - filtered) * gain + (end - begin) * (1.0 - ratio));
}
