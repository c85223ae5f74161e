/* Loads recordings by the paths on the standard input, one a line. Prints what is wrong with each, or its motion at
 * some times: displacement, velocity and acceleration. Corner frequency, fade and, if it is not C, the locale to load
 * them in come from the command line. Each answer is there before the next path is read. */
#include "replay.h"

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int count, char *words[])
{
    char path[4096];
    const double corner = atof(words[1]), fade = atof(words[2]);
    while (fgets(path, sizeof path, stdin) != NULL) {
        replay_spline spline;
        path[strcspn(path, "\n")] = '\0';
        if (setlocale(LC_ALL, count > 3 ? words[3] : "C") == NULL) {
            return 1;
        }
        const char *problem = replay_load(path, corner, fade, &spline);
        setlocale(LC_ALL, "C");
        if (problem != NULL) {
            printf("%s\n", problem);
            fflush(stdout);
            continue;
        }
        for (double time = -0.5; time < 3.0; time += 0.0371) {
            shaker_outputs floor;
            replay_motion(&spline, time, &floor);
            const double values[] = {floor.floor_displacement, floor.floor_velocity, floor.floor_acceleration};
            for (size_t i = 0; i < 3; ++i) {
                printf("%a ", values[i]);
            }
        }
        printf("\n");
        fflush(stdout);
        replay_free(&spline);
    }
    return 0;
}
