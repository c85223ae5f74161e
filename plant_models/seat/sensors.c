/* The sensors; explained in sensors.py. */
#include "sensors.h"

#include "random_numbers.h"
#include "subnormal.h"

#include <math.h>

/* How long noise is held in s, times that are one instant, and from where on numbers have no fraction. */
static const double tick = 0.002;
static const double same_instant = 1e-9;
static const double whole = 4503599627370496.0;

double sensor_spoiled(double value, const sensor_coefficients *sensor, double time)
{
    if (sensor->noise > 0.0) {
        value += sensor->noise * random_normal(sensor->stream, (int64_t)floor((time + same_instant) / tick));
    }
    if (sensor->bias != 0.0) {
        value += sensor->bias;
    }
    if (sensor->resolution > 0.0) {
        const double steps = value / sensor->resolution;
        if (fabs(steps) < whole) {
            value = sensor->resolution * floor(steps + 0.5);
        }
    }
    return value;
}

double sensor_low_passed(double filtered, double begin, double end, double angle)
{
    const double gain = -expm1(-angle);
    return flush_subnormal(filtered + (begin - filtered) * gain + (end - begin) * (1.0 - gain / angle));
}
