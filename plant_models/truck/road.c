/* Random road, obstacles and a road from a file; see road.py for the method. */
#include "road.h"

#include "random_numbers.h"
#include "smooth_step.h"

#include <math.h>
#include <stddef.h>

static const double pi = 3.14159265358979323846;

/* Number of cells of constant noise in a metre. */
static const double cells_per_metre = 20.0;

/* n_c and n_0 in cycle/m. */
static const double corner = 0.01, reference = 0.1;

/* Geometric mean of Gd(n_0) of the classes A to E of ISO 8608 in m3, one-sided. */
static const double levels[] = {16e-6, 64e-6, 256e-6, 1024e-6, 4096e-6};

const char *road_prepare(const truck_cab_parameters *p, road_coefficients *road)
{
    const recording_columns columns = {"distance", "m", {"elevation", NULL}};
    static const recording_samples none;
    const double cell = 1.0 / cells_per_metre;
    const double half = pi * corner * cell;
    road->profile = p->road_profile;
    road->decay = (1.0 - half) / (1.0 + half);
    road->gain = 2.0 * pi * reference * sqrt(0.5 * levels[p->road_class - 1] * cell) / (1.0 + half);
    road->stream = random_stream((uint32_t)p->road_seed, 0);
    road->fade = p->road_fade;
    road->height = p->obstacle_height;
    road->length = p->obstacle_length;
    road->position = p->obstacle_position;
    road->samples = none;
    if (p->road_profile != TRUCK_FILE) {
        return NULL;
    }
    return recording_read(p->road_file, &columns, &road->samples, road->message, sizeof road->message);
}

void road_release(road_coefficients *road)
{
    recording_free(&road->samples);
}

road_track road_before(void)
{
    const road_track before = {-1.0, 0.0, 0.0};
    return before;
}

void road_advance(road_track *track, double distance, const road_coefficients *road)
{
    if (road->profile != TRUCK_ISO8608) {
        return;
    }
    while (track->cell + 1.0 <= distance * cells_per_metre) {
        track->cell += 1.0;
        const double begin = track->end;
        track->end = road->decay * begin + road->gain * random_normal(road->stream, (int64_t)track->cell);
        track->begin = begin;
    }
}

/* Return the last sample at or before a distance, which is before the last sample. */
static size_t sample_before(const recording_samples *samples, double distance)
{
    size_t low = 0, high = samples->count - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (samples->axis[middle] <= distance) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Interpolate the elevation from a file; the road is flat after its end. */
static double recorded(double distance, const recording_samples *samples)
{
    const double *x = samples->axis, *z = samples->values;
    const size_t last = samples->count - 1;
    if (distance >= x[last]) {
        return z[last] - z[0];
    }
    const size_t i = sample_before(samples, distance);
    return z[i] + (z[i + 1] - z[i]) * ((distance - x[i]) / (x[i + 1] - x[i])) - z[0];
}

/* Evaluate a single obstacle: bump and pothole are one period of a cosine, the kerb is a smooth step. */
static double obstacle(double distance, const road_coefficients *road)
{
    const double share = (distance - road->position) / road->length;
    if (road->profile == TRUCK_KERB) {
        double step[3];
        smooth_step(share, step);
        return road->height * step[0];
    }
    if (!(share > 0.0 && share < 1.0)) {
        return 0.0;
    }
    const double rise = 0.5 * road->height * (1.0 - cos(2.0 * pi * share));
    return road->profile == TRUCK_POTHOLE ? -rise : rise;
}

double road_elevation(const road_track *track, double distance, const road_coefficients *road)
{
    double rough, step[3];
    if (distance <= 0.0) {
        return 0.0;
    }
    if (road->profile == TRUCK_ISO8608) {
        rough = track->begin + (track->end - track->begin) * (distance * cells_per_metre - track->cell);
    } else if (road->profile == TRUCK_FILE) {
        rough = recorded(distance, &road->samples);
    } else {
        return obstacle(distance, road);
    }
    smooth_step(distance / road->fade, step);
    return step[0] * rough;
}

int road_is_valid_track(const road_track *track, int profile, double distance, double tolerance)
{
    const road_track before = road_before();
    const double cells = distance * cells_per_metre, margin = tolerance * cells_per_metre + 1.0;
    if (track->cell == before.cell || profile != TRUCK_ISO8608) {
        return track->cell == before.cell && track->begin == before.begin && track->end == before.end &&
               (distance - tolerance <= 0.0 || profile != TRUCK_ISO8608);
    }
    return track->cell >= 0.0 && cells - margin <= track->cell && track->cell <= cells + margin;
}
