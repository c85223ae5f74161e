/* A quintic; see smooth_step.py. */
#include "smooth_step.h"

void smooth_step(double x, double step[3])
{
    const int within = x > 0.0 && x < 1.0;
    step[0] = within ? x * x * x * (10.0 + x * (6.0 * x - 15.0)) : x >= 1.0 ? 1.0 : 0.0;
    step[1] = within ? 30.0 * x * x * (1.0 - x) * (1.0 - x) : 0.0;
    step[2] = within ? 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) : 0.0;
}
