/* The seated body: four masses in a chain above the seat, the C twin of body.py, which has the equations and the
 * sources of the numbers. Sequences run upwards: pelvis and thighs, lower torso, chest and upper torso, head and neck.
 */
#ifndef BODY_H
#define BODY_H

#include <math.h>

enum { BODY_MASSES = 4 };

/* Published masses in kg; stiffnesses in N/m and dampings in N.s/m of the links inside the body, below the second mass
 * and those above it. */
static const double body_masses[BODY_MASSES] = {12.78, 8.62, 28.49, 5.31};
static const double body_stiffnesses[BODY_MASSES - 1] = {162800.0, 183000.0, 310000.0};
static const double body_dampings[BODY_MASSES - 1] = {4585.0, 4750.0, 400.0};

/* Coefficients of a body: 1/m in 1/kg; stiffness in N/m and damping in N.s/m of the link below each mass, the first
 * being the contact. */
typedef struct {
    double per_mass[BODY_MASSES], k[BODY_MASSES], c[BODY_MASSES];
} body_coefficients;

/* Scale the published body to a mass on the seat in kg; its contact, in N/m and N.s/m, is scaled as well. */
static inline void body_prepare(double mass, double contact_stiffness, double contact_damping, body_coefficients *body)
{
    const double scale = mass / (body_masses[0] + body_masses[1] + body_masses[2] + body_masses[3]);
    body->k[0] = scale * contact_stiffness;
    body->c[0] = scale * contact_damping;
    for (int i = 0; i < BODY_MASSES; ++i) {
        body->per_mass[i] = 1.0 / (scale * body_masses[i]);
        if (i > 0) {
            body->k[i] = scale * body_stiffnesses[i - 1];
            body->c[i] = scale * body_dampings[i - 1];
        }
    }
}

/* Return a bound of the fastest motion of the body in rad/s, from the links at each mass. */
static inline double body_fastest(const body_coefficients *body)
{
    double found = 0.0;
    for (int i = 0; i < BODY_MASSES; ++i) {
        const int top = i == BODY_MASSES - 1;
        const double k = top ? body->k[i] : body->k[i] + body->k[i + 1];
        const double c = top ? body->c[i] : body->c[i] + body->c[i + 1];
        const double speed = sqrt(k * body->per_mass[i]) + c * body->per_mass[i];
        found = speed > found ? speed : found;
    }
    return found;
}

/* Return the force of the body on the seat in N, up positive, from the deflection of the contact in m and its rate. */
static inline double body_contact_force(double deflection, double rate, const body_coefficients *body)
{
    return body->k[0] * deflection + body->c[0] * rate;
}

/* Write the accelerations in m/s2 at displacements in m and velocities in m/s; the contact force is that of the body on
 * the seat in N. */
static inline void body_accelerations(const double z[], const double v[], double contact, const body_coefficients *body,
                                      double a[])
{
    double below = contact;
    for (int i = 0; i < BODY_MASSES; ++i) {
        const int top = i == BODY_MASSES - 1;
        const double above = top ? 0.0 : body->k[i + 1] * (z[i + 1] - z[i]) + body->c[i + 1] * (v[i + 1] - v[i]);
        a[i] = (above - below) * body->per_mass[i];
        below = above;
    }
}

#endif
