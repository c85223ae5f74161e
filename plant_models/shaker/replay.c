/* Spline through recorded samples, double integration of accelerations; see replay.py for the method. */
#include "replay.h"

#include "profiles.h"
#include "recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* Memory of the high-pass, in periods of its corner frequency: then 1e-4 of a state remains. */
static const double memory = 2.0;

/* Index of the first quantity of a recorded motion. */
enum { ACCELERATION };

/* Degree of the trend; numbers of arrays in a spline and of working arrays. */
enum { DEGREE = 3, SPLINE_ARRAYS = 4, SCRATCH_ARRAYS = 6 };

/* Find the second derivatives at the knots of the cubic spline with zero slope at both ends. */
static void find_curvatures(size_t count, const double x[], const double y[], double curvatures[], double ratios[])
{
    double above = 0.0, curvature = 0.0, left = 0.0, slope = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double right = i + 1 < count ? x[i + 1] - x[i] : 0.0;
        const double next_slope = i + 1 < count ? (y[i + 1] - y[i]) / right : 0.0;
        const double pivot = 2.0 * (left + right) - left * above;
        curvature = (6.0 * (next_slope - slope) - left * curvature) / pivot;
        above = right / pivot;
        ratios[i] = above;
        curvatures[i] = curvature;
        left = right;
        slope = next_slope;
    }
    for (size_t i = count - 1; i-- > 0;) {
        curvatures[i] -= ratios[i] * curvatures[i + 1];
    }
}

/* Integrate the spline through accelerations twice, from rest. */
static void integrate_twice(size_t count, const double t[], const double a[], double displacements[],
                            double curvatures[], double ratios[])
{
    double velocity = 0.0, displacement = 0.0;
    find_curvatures(count, t, a, curvatures, ratios);
    displacements[0] = 0.0;
    for (size_t i = 0; i + 1 < count; ++i) {
        const double h = t[i + 1] - t[i];
        const double linear = h * h * (2.0 * a[i] + a[i + 1]) / 6.0;
        displacement += h * velocity + linear - h * h * h * h * (8.0 * curvatures[i] + 7.0 * curvatures[i + 1]) / 360.0;
        velocity += 0.5 * h * (a[i] + a[i + 1]) - h * h * h * (curvatures[i] + curvatures[i + 1]) / 24.0;
        displacements[i + 1] = displacement;
    }
}

/* Subtract the best cubic polynomial, one orthogonal polynomial after the other; t begins at 0. Uses four working
 * arrays. */
static void detrend(size_t count, const double t[], double d[], double *const scratch[])
{
    double *x = scratch[0], *weights = scratch[1], *polynomial = scratch[2], *before = scratch[3];
    double norm_before = 1.0;
    for (size_t i = 0; i < count; ++i) {
        x[i] = 2.0 * t[i] / t[count - 1] - 1.0;
        weights[i] = (1.0 - x[i] * x[i]) * (1.0 - x[i] * x[i]) * (t[i + 1 < count ? i + 1 : i] - t[i > 0 ? i - 1 : i]);
        polynomial[i] = 1.0;
        before[i] = 0.0;
    }
    for (int degree = 0; degree <= DEGREE; ++degree) {
        double norm = 0.0, share = 0.0, middle = 0.0;
        for (size_t i = 0; i < count; ++i) {
            norm += weights[i] * polynomial[i] * polynomial[i];
            share += weights[i] * polynomial[i] * d[i];
            middle += weights[i] * polynomial[i] * polynomial[i] * x[i];
        }
        share = share / norm;
        middle = middle / norm;
        const double carry = norm / norm_before;
        for (size_t i = 0; i < count; ++i) {
            const double p = polynomial[i];
            d[i] -= share * p;
            polynomial[i] = (x[i] - middle) * p - carry * before[i];
            before[i] = p;
        }
        norm_before = norm;
    }
}

/* Return the number of rows within the memory of the high-pass. */
static size_t memory_rows(size_t count, const double elapsed[], double corner)
{
    size_t rows = RECORDING_MIN_ROWS;
    while (rows < count && elapsed[rows] < memory / corner) {
        ++rows;
    }
    return rows;
}

/* Apply the high-pass s^2/(s^2 + sqrt 2 omega s + omega^2) in place, in the order of rising time since its begin: u -
 * sqrt 2 omega Re x with x' = pole x + u. It starts from the steady state under u mirrored at the begin of its trend,
 * over the memory of the filter. Uses five working arrays. */
static void high_pass(size_t count, const double elapsed[], double u[], double corner, double *const scratch[])
{
    const double omega = 2.0 * pi * corner;
    const double part = omega * sqrt(0.5);
    const size_t mirrored = memory_rows(count, elapsed, corner) - 1;
    double *detrended = scratch[4];
    for (size_t i = 0; i <= mirrored; ++i) {
        detrended[i] = u[i];
    }
    detrend(mirrored + 1, elapsed, detrended, scratch);
    const double trend = u[0] - detrended[0];
    double re = 0.0, im = 0.0, from = 2.0 * trend - u[mirrored], begin = -elapsed[mirrored];
    for (size_t k = 1; k < mirrored + count; ++k) {
        const int before = k < mirrored;
        const size_t i = before ? mirrored - k : k - mirrored;
        const double to = before ? 2.0 * trend - u[i] : u[i], end = before ? -elapsed[i] : elapsed[i];
        const double h = end - begin;
        const double size = exp(-part * (0.5 * h)), angle = part * (0.5 * h);
        const double half_re = size * cos(angle), half_im = size * sin(angle);
        /* Simpson's rule for the response to u, linear in between */
        const double start = re + h / 6.0 * from;
        const double middle_re = half_re * start - half_im * im + h / 3.0 * (from + to);
        const double middle_im = half_re * im + half_im * start;
        re = half_re * middle_re - half_im * middle_im + h / 6.0 * to;
        im = half_re * middle_im + half_im * middle_re;
        if (!before) {
            u[i] = to - 2.0 * part * re;
        }
        from = to;
        begin = end;
    }
}

/* Reverse the order of an array. */
static void reverse(size_t count, double x[])
{
    for (size_t i = 0; i < count / 2; ++i) {
        const double first = x[i];
        x[i] = x[count - 1 - i];
        x[count - 1 - i] = first;
    }
}

/* Find the displacements of the samples in m. */
static void find_displacements(const recording_samples *samples, double corner, double fade, double d[],
                               double *const scratch[SCRATCH_ARRAYS])
{
    const size_t count = samples->count;
    const double *t = samples->axis;
    if (samples->quantity != ACCELERATION) {
        for (size_t i = 0; i < count; ++i) {
            d[i] = samples->values[i] - samples->values[0];
        }
        return;
    }
    integrate_twice(count, t, samples->values, d, scratch[0], scratch[1]);
    detrend(count, t, d, scratch);
    for (int backward = 0; backward < 2 && corner > 0.0; ++backward) {
        double *elapsed = scratch[5];
        for (size_t i = 0; i < count; ++i) {
            elapsed[i] = backward ? fabs(t[count - 1 - i] - t[count - 1]) : t[i];
        }
        high_pass(count, elapsed, d, corner, scratch);
        reverse(count, d);
    }
    for (size_t i = 0; i < count; ++i) {
        double e[3];
        profile_envelope(t[i], t[count - 1], fade, e);
        d[i] = e[0] * d[i];
    }
}

/* Make the spline through samples, in its memory. */
static void make_spline(const recording_samples *samples, double corner, double fade, replay_spline *spline,
                        double *const scratch[SCRATCH_ARRAYS])
{
    const size_t count = samples->count;
    double *t = spline->memory, *d = t + count, *v = d + count, *a = v + count;
    spline->count = count;
    spline->times = t;
    spline->displacements = d;
    spline->velocities = v;
    spline->accelerations = a;
    for (size_t i = 0; i < count; ++i) {
        t[i] = samples->axis[i];
    }
    find_displacements(samples, corner, fade, d, scratch);
    find_curvatures(count, t, d, a, scratch[0]);
    for (size_t i = 0; i + 1 < count; ++i) {
        const double h = t[i + 1] - t[i];
        v[i] = (d[i + 1] - d[i]) / h - h * (2.0 * a[i] + a[i + 1]) / 6.0;
    }
    v[count - 1] = 0.0;
}

/* Allocate memory and make the spline. */
static const char *allocate_spline(const recording_samples *samples, double corner, double fade, replay_spline *spline)
{
    const size_t size = samples->count * sizeof(double);
    double *working = malloc(SCRATCH_ARRAYS * size), *scratch[SCRATCH_ARRAYS];
    spline->memory = malloc(SPLINE_ARRAYS * size);
    const int allocated = working != NULL && spline->memory != NULL;
    if (allocated) {
        for (size_t i = 0; i < SCRATCH_ARRAYS; ++i) {
            scratch[i] = working + i * samples->count;
        }
        make_spline(samples, corner, fade, spline, scratch);
    } else {
        replay_free(spline);
    }
    free(working);
    return allocated ? NULL : "expected memory for a recording, got none";
}

const char *replay_load(const char *path, double high_pass, double fade, replay_spline *spline)
{
    const recording_columns columns = {"time", "s", {"acceleration", "displacement"}};
    recording_samples samples;
    spline->memory = NULL;
    const char *problem = recording_read(path, &columns, &samples, spline->message, sizeof spline->message);
    if (problem != NULL) {
        return problem;
    }
    const double end = samples.axis[samples.count - 1];
    if (samples.quantity == ACCELERATION && !(end >= 2.0 * fade)) {
        snprintf(spline->message, sizeof spline->message,
                 "%s: expected a recording as long as two fades, %.10g s, got %.10g s", path, 2.0 * fade, end);
        problem = spline->message;
    } else {
        problem = allocate_spline(&samples, high_pass, fade, spline);
    }
    recording_free(&samples);
    return problem;
}

void replay_free(replay_spline *spline)
{
    free(spline->memory);
    spline->memory = NULL;
}

/* Return the knot before a time, from the first to the last but one. */
static size_t knot_before(const replay_spline *spline, double time)
{
    size_t low = 0, high = spline->count - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (spline->times[middle] <= time) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

void replay_motion(const replay_spline *spline, double time, shaker_outputs *floor)
{
    const double *t = spline->times, *v = spline->velocities, *a = spline->accelerations;
    const size_t last = spline->count - 1;
    floor->floor_displacement = floor->floor_velocity = floor->floor_acceleration = 0.0;
    if (time >= t[last] - SHAKER_TIME_TOLERANCE) {
        floor->floor_displacement = spline->displacements[last];
    } else if (time >= -SHAKER_TIME_TOLERANCE) {
        const size_t i = knot_before(spline, time);
        const double elapsed = time - t[i];
        const double jerk = (a[i + 1] - a[i]) / (t[i + 1] - t[i]);
        floor->floor_displacement =
            spline->displacements[i] + elapsed * (v[i] + elapsed * (0.5 * a[i] + elapsed * jerk / 6.0));
        floor->floor_velocity = v[i] + elapsed * (a[i] + 0.5 * elapsed * jerk);
        floor->floor_acceleration = a[i] + elapsed * jerk;
    }
}
