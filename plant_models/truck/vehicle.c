/* Equations of motion and Runge-Kutta; see vehicle.py for the derivation. */
#include "vehicle.h"

#include "subnormal.h"

#include <math.h>
#include <stddef.h>

/* Longest and shortest substep in s, substeps per radian of the fastest motion; see vehicle.py. */
static const double max_substep_length = 2e-3, min_substep_length = 1e-5, substeps_per_radian = 2.0;

typedef vehicle_coefficients coefficients_t;

/* Return the longest substep in s for the fastest motion of these parameters, which the traces of M^-1 K and M^-1 C
 * bound. */
static double max_substep(const coefficients_t *c)
{
    const double front_mount = c->per_m_c + c->b_1 * c->b_1 * c->per_I_c + c->per_m_s + c->e_1 * c->e_1 * c->per_I_s;
    const double rear_mount = c->per_m_c + c->b_2 * c->b_2 * c->per_I_c + c->per_m_s + c->e_2 * c->e_2 * c->per_I_s;
    const double front = c->per_m_s + c->l_1 * c->l_1 * c->per_I_s + c->per_m_1;
    const double rear = c->per_m_s + c->l_2 * c->l_2 * c->per_I_s + c->per_m_2;
    const double sprung = c->k_c1 * front_mount + c->k_c2 * rear_mount + c->k_1 * front + c->k_2 * rear;
    const double stiffness = sprung + c->k_t1 * c->per_m_1 + c->k_t2 * c->per_m_2;
    const double damping = c->c_c1 * front_mount + c->c_c2 * rear_mount + c->c_1 * front + c->c_2 * rear;
    const double fastest = sqrt(stiffness) + damping;
    const double needed = fastest == 0.0 ? max_substep_length : 1.0 / (substeps_per_radian * fastest);
    return needed > max_substep_length ? max_substep_length : needed;
}

const char *vehicle_prepare(const truck_cab_parameters *p, coefficients_t *c)
{
    const double cab = p->chassis_position - p->cab_position;
    if (!(p->chassis_position <= p->wheelbase)) {
        return "expected chassis.position up to chassis.wheelbase: the axles carry the chassis";
    }
    c->per_m_c = 1.0 / p->cab_mass;
    c->per_I_c = 1.0 / p->cab_pitch_inertia;
    c->per_m_s = 1.0 / p->chassis_mass;
    c->per_I_s = 1.0 / p->chassis_pitch_inertia;
    c->per_m_1 = 1.0 / p->front_axle_mass;
    c->per_m_2 = 1.0 / p->rear_axle_mass;
    c->b_1 = p->cab_front_mount;
    c->b_2 = p->cab_rear_mount;
    c->e_1 = cab + p->cab_front_mount;
    c->e_2 = cab - p->cab_rear_mount;
    c->l_1 = p->chassis_position;
    c->l_2 = p->wheelbase - p->chassis_position;
    c->d = p->seat_position;
    c->k_c1 = p->cab_front_stiffness;
    c->k_c2 = p->cab_rear_stiffness;
    c->k_1 = p->front_stiffness;
    c->k_2 = p->rear_stiffness;
    c->k_t1 = p->front_tyre_stiffness;
    c->k_t2 = p->rear_tyre_stiffness;
    c->c_c1 = p->cab_front_damping;
    c->c_c2 = p->cab_rear_damping;
    c->c_1 = p->front_damping;
    c->c_2 = p->rear_damping;
    c->substep = max_substep(c);
    if (!(c->substep >= min_substep_length)) {
        return "expected a fastest motion below 50000 rad/s from the stiffnesses and dampings of cab mounts, "
               "suspensions "
               "and tyres on the masses and inertias";
    }
    return NULL;
}

/* Solve the equations of motion for the accelerations in m/s2 and rad/s2. */
static void find_accelerations(const double z[], const double v[], const vehicle_road *road, double force,
                               const coefficients_t *c, double a[])
{
    const double z_c = z[0], theta_c = z[1], z_s = z[2], theta_s = z[3], z_1 = z[4], z_2 = z[5];
    const double v_c = v[0], omega_c = v[1], v_s = v[2], omega_s = v[3], v_1 = v[4], v_2 = v[5];
    const double f_c1 = c->k_c1 * ((z_s - c->e_1 * theta_s) - (z_c - c->b_1 * theta_c)) +
                        c->c_c1 * ((v_s - c->e_1 * omega_s) - (v_c - c->b_1 * omega_c));
    const double f_c2 = c->k_c2 * ((z_s - c->e_2 * theta_s) - (z_c + c->b_2 * theta_c)) +
                        c->c_c2 * ((v_s - c->e_2 * omega_s) - (v_c + c->b_2 * omega_c));
    const double f_1 = c->k_1 * (z_1 - (z_s - c->l_1 * theta_s)) + c->c_1 * (v_1 - (v_s - c->l_1 * omega_s));
    const double f_2 = c->k_2 * (z_2 - (z_s + c->l_2 * theta_s)) + c->c_2 * (v_2 - (v_s + c->l_2 * omega_s));
    a[0] = (f_c1 + f_c2 + force) * c->per_m_c;
    a[1] = (c->b_2 * f_c2 - c->b_1 * f_c1 - c->d * force) * c->per_I_c;
    a[2] = (f_1 + f_2 - f_c1 - f_c2) * c->per_m_s;
    a[3] = (c->l_2 * f_2 - c->l_1 * f_1 + c->e_1 * f_c1 + c->e_2 * f_c2) * c->per_I_s;
    a[4] = (c->k_t1 * (road->front - z_1) - f_1) * c->per_m_1;
    a[5] = (c->k_t2 * (road->rear - z_2) - f_2) * c->per_m_2;
}

/* Find x + time rate. */
static void move(const double x[], double time, const double rate[], double moved[])
{
    for (int i = 0; i < VEHICLE_DEGREES; ++i) {
        moved[i] = x[i] + time * rate[i];
    }
}

/* Advance x by a substep of six `sixth` with the rates of its four stages. */
static void combine(double x[], double sixth, const double r_1[], const double r_2[], const double r_3[],
                    const double r_4[])
{
    for (int i = 0; i < VEHICLE_DEGREES; ++i) {
        x[i] = flush_subnormal(x[i] + sixth * (r_1[i] + 2.0 * (r_2[i] + r_3[i]) + r_4[i]));
    }
}

void vehicle_substep(vehicle_motion *motion, double h, const vehicle_road roads[3], const double forces[3],
                     const coefficients_t *c)
{
    double *z = motion->z, *v = motion->v, stage[VEHICLE_DEGREES];
    double v_2[VEHICLE_DEGREES], v_3[VEHICLE_DEGREES], v_4[VEHICLE_DEGREES];
    double a[VEHICLE_DEGREES], a_2[VEHICLE_DEGREES], a_3[VEHICLE_DEGREES], a_4[VEHICLE_DEGREES];
    const double half = 0.5 * h, sixth = h / 6.0;
    find_accelerations(z, v, &roads[0], forces[0], c, a);
    move(v, half, a, v_2);
    move(z, half, v, stage);
    find_accelerations(stage, v_2, &roads[1], forces[1], c, a_2);
    move(v, half, a_2, v_3);
    move(z, half, v_2, stage);
    find_accelerations(stage, v_3, &roads[1], forces[1], c, a_3);
    move(v, h, a_3, v_4);
    move(z, h, v_3, stage);
    find_accelerations(stage, v_4, &roads[2], forces[2], c, a_4);
    combine(z, sixth, v, v_2, v_3, v_4);
    combine(v, sixth, a, a_2, a_3, a_4);
}

void vehicle_outputs(const vehicle_motion *motion, const vehicle_road *road, double force, const coefficients_t *c,
                     truck_cab_outputs *outputs)
{
    const double *z = motion->z, *v = motion->v;
    double a[VEHICLE_DEGREES];
    find_accelerations(z, v, road, force, c, a);
    outputs->floor_displacement = z[0] - c->d * z[1];
    outputs->floor_velocity = v[0] - c->d * v[1];
    outputs->floor_acceleration = a[0] - c->d * a[1];
    outputs->road_elevation = road->front;
    outputs->chassis_acceleration = a[2];
    outputs->cab_pitch = z[1];
    outputs->front_tyre_force = c->k_t1 * (road->front - z[4]);
    outputs->rear_tyre_force = c->k_t2 * (road->rear - z[5]);
}
