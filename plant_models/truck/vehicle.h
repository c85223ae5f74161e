/* Cab, chassis and two axles in a plane, the C twin of vehicle.py. No globals, no memory, no recursion. */
#ifndef VEHICLE_H
#define VEHICLE_H

#include "interface.h"

/* Number of degrees of freedom: z_c, theta_c, z_s, theta_s, z_1, z_2. */
enum { VEHICLE_DEGREES = 6 };

/* In the symbols of vehicle.py. */
typedef struct {
    double per_m_c, per_I_c, per_m_s, per_I_s, per_m_1, per_m_2; /* in 1/kg and 1/(kg.m2) */
    double b_1, b_2, e_1, e_2, l_1, l_2, d;                      /* in m */
    double k_c1, k_c2, k_1, k_2, k_t1, k_t2;                     /* in N/m */
    double c_c1, c_c2, c_1, c_2;                                 /* in N.s/m */
    double substep;                                              /* longest Runge-Kutta substep in s */
} vehicle_coefficients;

/* Displacements in m and rad, and their rates. */
typedef struct {
    double z[VEHICLE_DEGREES], v[VEHICLE_DEGREES];
} vehicle_motion;

/* Elevation of the road under front and rear axle in m. */
typedef struct {
    double front, rear;
} vehicle_road;

/* Derive the coefficients. Returns NULL, or a message about the parameters in terms of their names. */
const char *vehicle_prepare(const truck_cab_parameters *parameters, vehicle_coefficients *coefficients);

/* Take one step of classical Runge-Kutta of a length in s, with the road and the force of the seat in N at its begin,
 * middle and end. */
void vehicle_substep(vehicle_motion *motion, double h, const vehicle_road roads[3], const double forces[3],
                     const vehicle_coefficients *coefficients);

/* Evaluate the outputs. */
void vehicle_outputs(const vehicle_motion *motion, const vehicle_road *road, double force,
                     const vehicle_coefficients *coefficients, truck_cab_outputs *outputs);

#endif
