/* Spline through recorded samples, and how an acceleration becomes a displacement; explained in replay.py. */
#include "replay.h"

#include "profiles.h"
#include "recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* Of the high-pass, in periods of its corner frequency: then 1e-4 of a state is left. */
static const double memory = 2.0;

enum { DEGREE = 3, KEPT = 4, SCRATCH = 6 };

/* Second derivatives at the knots of the cubic spline whose slope is zero at both ends. */
static void solve_bends(size_t count, const double x[], const double y[], double bends[], double ratios[])
{
    double above = 0.0, bend = 0.0, left = 0.0, rise = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double right = i + 1 < count ? x[i + 1] - x[i] : 0.0;
        const double next_rise = i + 1 < count ? (y[i + 1] - y[i]) / right : 0.0;
        const double pivot = 2.0 * (left + right) - left * above;
        bend = (6.0 * (next_rise - rise) - left * bend) / pivot;
        above = right / pivot;
        ratios[i] = above;
        bends[i] = bend;
        left = right;
        rise = next_rise;
    }
    for (size_t i = count - 1; i-- > 0;) {
        bends[i] -= ratios[i] * bends[i + 1];
    }
}

/* Integrate the spline through accelerations from rest. */
static void integrate_twice(size_t count, const double t[], const double a[], double displacements[], double bends[],
                            double ratios[])
{
    double velocity = 0.0, displacement = 0.0;
    solve_bends(count, t, a, bends, ratios);
    displacements[0] = 0.0;
    for (size_t i = 0; i + 1 < count; ++i) {
        const double h = t[i + 1] - t[i];
        const double linear = h * h * (2.0 * a[i] + a[i + 1]) / 6.0;
        displacement += h * velocity + linear - h * h * h * h * (8.0 * bends[i] + 7.0 * bends[i + 1]) / 360.0;
        velocity += 0.5 * h * (a[i] + a[i + 1]) - h * h * h * (bends[i] + bends[i + 1]) / 24.0;
        displacements[i + 1] = displacement;
    }
}

/* Subtract the best cubic polynomial, one orthogonal polynomial after the other; t from 0. Four arrays to work with. */
static void detrend(size_t count, const double t[], double d[], double *const scratch[])
{
    double *x = scratch[0], *weights = scratch[1], *polynomial = scratch[2], *before = scratch[3];
    double size_before = 1.0;
    for (size_t i = 0; i < count; ++i) {
        x[i] = 2.0 * t[i] / t[count - 1] - 1.0;
        weights[i] = (1.0 - x[i] * x[i]) * (1.0 - x[i] * x[i]) * (t[i + 1 < count ? i + 1 : i] - t[i > 0 ? i - 1 : i]);
        polynomial[i] = 1.0;
        before[i] = 0.0;
    }
    for (int degree = 0; degree <= DEGREE; ++degree) {
        double size = 0.0, share = 0.0, middle = 0.0;
        for (size_t i = 0; i < count; ++i) {
            size += weights[i] * polynomial[i] * polynomial[i];
            share += weights[i] * polynomial[i] * d[i];
            middle += weights[i] * polynomial[i] * polynomial[i] * x[i];
        }
        share = share / size;
        middle = middle / size;
        const double carry = size / size_before;
        for (size_t i = 0; i < count; ++i) {
            const double p = polynomial[i];
            d[i] -= share * p;
            polynomial[i] = (x[i] - middle) * p - carry * before[i];
            before[i] = p;
        }
        size_before = size;
    }
}

/* Rows from the begin that the high-pass remembers. */
static size_t remembered(size_t count, const double since[], double corner)
{
    size_t rows = RECORDING_FEWEST_ROWS;
    while (rows < count && since[rows] < memory / corner) {
        ++rows;
    }
    return rows;
}

/* Pass u through s^2/(s^2 + sqrt 2 omega s + omega^2) in place, in the order of rising time since its begin: u - sqrt 2
 * omega Re x with x' = pole x + u. The filter has settled before: on u turned about the begin of its trend, for as long as
 * the filter remembers. Five arrays to work with. */
static void pass_high(size_t count, const double since[], double u[], double corner, double *const scratch[])
{
    const double omega = 2.0 * pi * corner;
    const double part = omega * sqrt(0.5);
    const size_t turned = remembered(count, since, corner) - 1;
    double *piece = scratch[4];
    for (size_t i = 0; i <= turned; ++i) {
        piece[i] = u[i];
    }
    detrend(turned + 1, since, piece, scratch);
    const double trend = u[0] - piece[0];
    double re = 0.0, im = 0.0, from = 2.0 * trend - u[turned], begin = -since[turned];
    for (size_t k = 1; k < turned + count; ++k) {
        const int before = k < turned;
        const size_t i = before ? turned - k : k - turned;
        const double to = before ? 2.0 * trend - u[i] : u[i], end = before ? -since[i] : since[i];
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

static void reverse(size_t count, double x[])
{
    for (size_t i = 0; i < count / 2; ++i) {
        const double first = x[i];
        x[i] = x[count - 1 - i];
        x[count - 1 - i] = first;
    }
}

/* Displacements of samples, in m. */
static void find_displacements(const recording_samples *samples, double corner, double fade, double d[],
                               double *const scratch[SCRATCH])
{
    const size_t count = samples->count;
    const double *t = samples->times;
    if (!samples->of_acceleration) {
        for (size_t i = 0; i < count; ++i) {
            d[i] = samples->values[i] - samples->values[0];
        }
        return;
    }
    integrate_twice(count, t, samples->values, d, scratch[0], scratch[1]);
    detrend(count, t, d, scratch);
    for (int backward = 0; backward < 2 && corner > 0.0; ++backward) {
        double *since = scratch[5];
        for (size_t i = 0; i < count; ++i) {
            since[i] = backward ? fabs(t[count - 1 - i] - t[count - 1]) : t[i];
        }
        pass_high(count, since, d, corner, scratch);
        reverse(count, d);
    }
    for (size_t i = 0; i < count; ++i) {
        double e[3];
        profile_envelope(t[i], t[count - 1], fade, e);
        d[i] = e[0] * d[i];
    }
}

/* Make the curve of samples, in its memory. */
static void make_curve(const recording_samples *samples, double corner, double fade, replay_curve *curve,
                       double *const scratch[SCRATCH])
{
    const size_t count = samples->count;
    double *t = curve->memory, *d = t + count, *v = d + count, *a = v + count;
    curve->count = count;
    curve->times = t;
    curve->displacements = d;
    curve->velocities = v;
    curve->accelerations = a;
    for (size_t i = 0; i < count; ++i) {
        t[i] = samples->times[i];
    }
    find_displacements(samples, corner, fade, d, scratch);
    solve_bends(count, t, d, a, scratch[0]);
    for (size_t i = 0; i + 1 < count; ++i) {
        const double h = t[i + 1] - t[i];
        v[i] = (d[i + 1] - d[i]) / h - h * (2.0 * a[i] + a[i + 1]) / 6.0;
    }
    v[count - 1] = 0.0;
}

/* The same with memory for it. */
static const char *allocate_and_make(const recording_samples *samples, double corner, double fade, replay_curve *curve)
{
    const size_t size = samples->count * sizeof(double);
    double *room = malloc(SCRATCH * size), *scratch[SCRATCH];
    curve->memory = malloc(KEPT * size);
    const int fine = room != NULL && curve->memory != NULL;
    if (fine) {
        for (size_t i = 0; i < SCRATCH; ++i) {
            scratch[i] = room + i * samples->count;
        }
        make_curve(samples, corner, fade, curve, scratch);
    } else {
        replay_free(curve);
    }
    free(room);
    return fine ? NULL : "expected memory for a recording, got none";
}

const char *replay_load(const char *path, double high_pass, double fade, replay_curve *curve)
{
    recording_samples samples;
    curve->memory = NULL;
    const char *problem = recording_read(path, &samples, curve->message, sizeof curve->message);
    if (problem != NULL) {
        return problem;
    }
    const double end = samples.times[samples.count - 1];
    if (samples.of_acceleration && !(end >= 2.0 * fade)) {
        snprintf(curve->message, sizeof curve->message,
                 "%s: expected a recording as long as two fades, %.10g s, got %.10g s", path, 2.0 * fade, end);
        problem = curve->message;
    } else {
        problem = allocate_and_make(&samples, high_pass, fade, curve);
    }
    recording_free(&samples);
    return problem;
}

void replay_free(replay_curve *curve)
{
    free(curve->memory);
    curve->memory = NULL;
}

/* The knot before a time, from the first to the last but one. */
static size_t knot_before(const replay_curve *curve, double time)
{
    size_t low = 0, high = curve->count - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (curve->times[middle] <= time) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

void replay_motion(const replay_curve *curve, double time, shaker_outputs *floor)
{
    const double *t = curve->times, *v = curve->velocities, *a = curve->accelerations;
    const size_t last = curve->count - 1;
    floor->floor_displacement = floor->floor_velocity = floor->floor_acceleration = 0.0;
    if (time >= t[last] - SHAKER_SAME_INSTANT) {
        floor->floor_displacement = curve->displacements[last];
    } else if (time >= -SHAKER_SAME_INSTANT) {
        const size_t i = knot_before(curve, time);
        const double since = time - t[i];
        const double jerk = (a[i + 1] - a[i]) / (t[i + 1] - t[i]);
        floor->floor_displacement =
            curve->displacements[i] + since * (v[i] + since * (0.5 * a[i] + since * jerk / 6.0));
        floor->floor_velocity = v[i] + since * (a[i] + 0.5 * since * jerk);
        floor->floor_acceleration = a[i] + since * jerk;
    }
}
