/* Seeded white noise through Butterworth filters in partial fractions; see noise.py for the method. */
#include "noise.h"

#include "random_numbers.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

typedef noise_complex complex_t;

/* Spectrum of the acceleration of a class: orders and corner frequencies in Hz of the Butterworth high-pass and
 * low-pass, level g in (m/s2)2/Hz. */
typedef struct {
    int high_order;
    double high_corner;
    int low_order;
    double low_corner, level;
} spectrum_t;

/* Spectra of the classes in ISO 7096 (EM), EN 13490 (IT) and ISO 5007 (AG); noise.py names their source. */
static const spectrum_t spectra[] = {
    {4, 1.5, 4, 2.5, 2.82},   /* EM1 */
    {4, 1.5, 4, 3.0, 2.72},   /* EM2 */
    {4, 1.5, 4, 3.0, 1.93},   /* EM3 */
    {4, 1.5, 4, 3.0, 0.60},   /* EM4 */
    {4, 1.5, 1, 3.5, 1.11},   /* EM5 */
    {2, 6.5, 2, 9.0, 0.79},   /* EM6 */
    {8, 3.0, 8, 3.5, 9.25},   /* EM7 */
    {4, 3.0, 2, 3.0, 1.45},   /* EM8 */
    {4, 3.5, 2, 4.0, 2.10},   /* EM9 */
    {4, 4.5, 2, 5.0, 1.66},   /* IT1 */
    {4, 3.0, 2, 3.0, 1.45},   /* IT2 */
    {4, 1.5, 4, 3.0, 0.60},   /* IT3 */
    {4, 1.5, 4, 3.0, 1.64},   /* IT4 */
    {8, 3.0, 8, 3.5, 9.25},   /* AG1 */
    {8, 2.1, 8, 2.6, 7.22},   /* AG2 */
    {8, 1.95, 8, 2.45, 5.85}, /* AG3 */
};

/* ---- complex numbers --------------------------------------------------------------------------------------------- */

static complex_t complex_of(double re, double im)
{
    const complex_t z = {re, im};
    return z;
}

static complex_t times(complex_t a, complex_t b)
{
    return complex_of(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re);
}

static complex_t inverse(complex_t z)
{
    const double size = z.re * z.re + z.im * z.im;
    return complex_of(z.re / size, -z.im / size);
}

static double real_part_of_product(complex_t a, complex_t b)
{
    return a.re * b.re - a.im * b.im;
}

/* ---- modes ------------------------------------------------------------------------------------------------------- */

/* Append the poles of a Butterworth filter with Im >= 0, in rad/s, for a corner frequency in Hz; returns the new count.
 */
static int add_butterworth_poles(int order, double corner, complex_t poles[], int count)
{
    const double omega = 2.0 * pi * corner;
    for (int k = 0; k < order / 2; ++k) {
        const double angle = pi * (double)(2 * k + order + 1) / (double)(2 * order);
        poles[count++] = complex_of(omega * cos(angle), omega * sin(angle));
    }
    if (order % 2 != 0) {
        poles[count++] = complex_of(-omega, 0.0);
    }
    return count;
}

/* Give exp(p t) and (exp(p t) - 1)/p: factors on the state of a mode and on held noise over a time in s. */
static void discretize(complex_t pole, double time, complex_t *transition, complex_t *input_gain)
{
    const double size = exp(pole.re * time), angle = pole.im * time;
    *transition = complex_of(size * cos(angle), size * sin(angle));
    *input_gain = times(complex_of(transition->re - 1.0, transition->im), inverse(pole));
}

/* Derive a mode from its residue at the i-th pole; `order` is that of the high-pass. */
static void prepare_mode(int i, const complex_t poles[], int count, int order, double gain, double tick,
                         noise_mode *mode)
{
    const complex_t pole = poles[i];
    complex_t residue = complex_of(gain, 0.0);
    for (int k = 0; k < order; ++k) {
        residue = times(residue, pole);
    }
    for (int j = 0; j < count; ++j) {
        if (j != i) {
            residue = times(residue, inverse(complex_of(pole.re - poles[j].re, pole.im - poles[j].im)));
        }
        if (poles[j].im > 0.0) {
            residue = times(residue, inverse(complex_of(pole.re - poles[j].re, pole.im + poles[j].im)));
        }
    }
    if (pole.im > 0.0) {
        residue = complex_of(residue.re * 2.0, residue.im * 2.0);
    }
    mode->pole = pole;
    mode->acceleration = residue;
    mode->velocity = times(residue, inverse(pole));
    mode->displacement = times(mode->velocity, inverse(pole));
    discretize(pole, tick, &mode->transition, &mode->input_gain);
}

void noise_prepare(int random_class, double scale, double tick, noise_coefficients *coefficients)
{
    const spectrum_t *spectrum = &spectra[random_class - 1];
    complex_t poles[NOISE_MAX_MODES];
    int count = add_butterworth_poles(spectrum->high_order, spectrum->high_corner, poles, 0);
    double gain = scale * sqrt(spectrum->level / (2.0 * tick));
    count = add_butterworth_poles(spectrum->low_order, spectrum->low_corner, poles, count);
    for (int k = 0; k < spectrum->low_order; ++k) {
        gain = gain * (2.0 * pi * spectrum->low_corner);
    }
    coefficients->count = count;
    for (int i = 0; i < count; ++i) {
        prepare_mode(i, poles, count, spectrum->high_order, gain, tick, &coefficients->modes[i]);
    }
}

/* ---- motion ------------------------------------------------------------------------------------------------------ */

/* Return the state of a mode after a time under held noise. */
static complex_t advanced(complex_t x, complex_t transition, complex_t input_gain, double noise)
{
    const complex_t grown = times(transition, x);
    return complex_of(grown.re + input_gain.re * noise, grown.im + input_gain.im * noise);
}

void noise_advance(double state[], const noise_coefficients *coefficients, uint64_t stream, double tick)
{
    const double noise = random_normal(stream, (int64_t)tick);
    for (int i = 0; i < coefficients->count; ++i) {
        const noise_mode *mode = &coefficients->modes[i];
        const complex_t x =
            advanced(complex_of(state[2 * i], state[2 * i + 1]), mode->transition, mode->input_gain, noise);
        state[2 * i] = x.re;
        state[2 * i + 1] = x.im;
    }
}

void noise_motion(const double state[], const noise_coefficients *coefficients, uint64_t stream, double tick,
                  double elapsed, shaker_outputs *floor)
{
    const double noise = elapsed > 0.0 ? random_normal(stream, (int64_t)tick) : 0.0;
    floor->floor_displacement = floor->floor_velocity = floor->floor_acceleration = 0.0;
    for (int i = 0; i < coefficients->count; ++i) {
        const noise_mode *mode = &coefficients->modes[i];
        complex_t x = complex_of(state[2 * i], state[2 * i + 1]);
        if (elapsed > 0.0) {
            complex_t transition, input_gain;
            discretize(mode->pole, elapsed, &transition, &input_gain);
            x = advanced(x, transition, input_gain, noise);
        }
        floor->floor_displacement += real_part_of_product(mode->displacement, x);
        floor->floor_velocity += real_part_of_product(mode->velocity, x);
        floor->floor_acceleration += real_part_of_product(mode->acceleration, x);
    }
}
