/* The seat suspension as a C program of its own: three FMUs by dlopen, the calls of the master, time and six signals
 * kept. Prints us per step of its second run; writes the rows to the file that is named to it. */
#define _POSIX_C_SOURCE 199309L

#include "fmi2Functions.h"
#include "system.h" /* where the FMUs lie, their GUIDs and value references: written by masters.py */

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { WIDTH = 7 };

typedef struct {
    fmi2Component component;
    fmi2SetRealTYPE *set;
    fmi2GetRealTYPE *get;
    fmi2GetBooleanTYPE *get_boolean;
    fmi2GetIntegerTYPE *get_integer;
    fmi2DoStepTYPE *step;
    fmi2ResetTYPE *reset;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *exit;
    fmi2TerminateTYPE *terminate;
} Fmu;

static void check(int fine)
{
    if (!fine) {
        fprintf(stderr, "a call failed\n");
        exit(1);
    }
}

static void logger(fmi2ComponentEnvironment it, fmi2String name, fmi2Status status, fmi2String kind, fmi2String text,
                   ...)
{
    (void)it, (void)status, (void)kind;
    fprintf(stderr, "%s: %s\n", name, text);
}

static Fmu load(const char *name, const char *library, const char *guid)
{
    static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    void *handle = dlopen(library, RTLD_NOW);
    check(handle != NULL);
    fmi2InstantiateTYPE *instantiate = (fmi2InstantiateTYPE *)dlsym(handle, "fmi2Instantiate");
    return (Fmu){instantiate(name, fmi2CoSimulation, guid, "", &callbacks, fmi2False, fmi2True),
                 (fmi2SetRealTYPE *)dlsym(handle, "fmi2SetReal"),
                 (fmi2GetRealTYPE *)dlsym(handle, "fmi2GetReal"),
                 (fmi2GetBooleanTYPE *)dlsym(handle, "fmi2GetBoolean"),
                 (fmi2GetIntegerTYPE *)dlsym(handle, "fmi2GetInteger"),
                 (fmi2DoStepTYPE *)dlsym(handle, "fmi2DoStep"),
                 (fmi2ResetTYPE *)dlsym(handle, "fmi2Reset"),
                 (fmi2EnterInitializationModeTYPE *)dlsym(handle, "fmi2EnterInitializationMode"),
                 (fmi2ExitInitializationModeTYPE *)dlsym(handle, "fmi2ExitInitializationMode"),
                 (fmi2TerminateTYPE *)dlsym(handle, "fmi2Terminate")};
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static fmi2Real floor_[SHAKER_OUTPUTS], seat_[SEAT_OUTPUTS], control[CONTROLLER_OUTPUTS];
static fmi2Boolean flags[CONTROLLER_FLAGS];
static fmi2Integer codes[CONTROLLER_CODES];

static void get_control(const Fmu *controller)
{
    check(controller->get(controller->component, controller_outputs, CONTROLLER_OUTPUTS, control) == fmi2OK);
    check(controller->get_boolean(controller->component, controller_flags, CONTROLLER_FLAGS, flags) == fmi2OK);
    check(controller->get_integer(controller->component, controller_codes, CONTROLLER_CODES, codes) == fmi2OK);
}

static void get_all(const Fmu *shaker, const Fmu *seat, const Fmu *controller)
{
    check(shaker->get(shaker->component, shaker_outputs, SHAKER_OUTPUTS, floor_) == fmi2OK);
    check(seat->get(seat->component, seat_outputs, SEAT_OUTPUTS, seat_) == fmi2OK);
    get_control(controller);
}

static void step(const Fmu *it, double time)
{
    check(it->step(it->component, time, STEP_SIZE, fmi2True) == fmi2OK);
}

static void record(double row[WIDTH], double time)
{
    row[0] = time;
    row[1] = floor_[SHAKER_floor_displacement];
    row[2] = seat_[SEAT_suspension_deflection];
    row[3] = floor_[SHAKER_floor_acceleration];
    row[4] = seat_[SEAT_seat_acceleration];
    row[5] = seat_[SEAT_driver_acceleration];
}

/* Step from 0 to the stop time; returns us per step. */
static double run(const Fmu *shaker, const Fmu *seat, const Fmu *controller, double (*rows)[WIDTH])
{
    const double begin = now();
    for (int k = 0; k < STEPS; ++k) {
        const double t = (double)k * STEP_SIZE;
        record(rows[k], t);
        const fmi2Real measured[] = {seat_[SEAT_seat_acceleration_measured],
                                     seat_[SEAT_suspension_deflection_measured]};
        check(controller->set(controller->component, controller_inputs, 2, measured) == fmi2OK);
        step(controller, t);
        get_control(controller);
        const fmi2Real felt[] = {floor_[SHAKER_floor_displacement], floor_[SHAKER_floor_velocity],
                                 floor_[SHAKER_floor_acceleration], control[CONTROLLER_force]};
        check(seat->set(seat->component, seat_inputs, 4, felt) == fmi2OK);
        step(seat, t);
        check(seat->get(seat->component, seat_outputs, SEAT_OUTPUTS, seat_) == fmi2OK);
        step(shaker, t);
        check(shaker->get(shaker->component, shaker_outputs, SHAKER_OUTPUTS, floor_) == fmi2OK);
        rows[k][6] = control[CONTROLLER_force];
    }
    record(rows[STEPS], (double)STEPS * STEP_SIZE);
    rows[STEPS][6] = control[CONTROLLER_force];
    return (now() - begin) / STEPS;
}

int main(int count, char *arguments[])
{
    Fmu fmus[] = {load("shaker", SHAKER_LIBRARY, SHAKER_GUID), load("seat", SEAT_LIBRARY, SEAT_GUID),
                  load("controller", CONTROLLER_LIBRARY, CONTROLLER_GUID)};
    double (*rows)[WIDTH] = NULL, spent = 0.0;
    for (int round = 0; round < 2; ++round) {
        for (int i = 0; i < 3; ++i) {
            check(fmus[i].reset(fmus[i].component) == fmi2OK && fmus[i].enter(fmus[i].component) == fmi2OK);
        }
        get_all(&fmus[0], &fmus[1], &fmus[2]);
        for (int i = 0; i < 3; ++i) {
            check(fmus[i].exit(fmus[i].component) == fmi2OK);
        }
        get_all(&fmus[0], &fmus[1], &fmus[2]);
        free(rows);
        rows = malloc((STEPS + 1) * sizeof *rows);
        spent = run(&fmus[0], &fmus[1], &fmus[2], rows);
        for (int i = 0; i < 3; ++i) {
            check(fmus[i].terminate(fmus[i].component) == fmi2OK);
        }
    }
    FILE *file = count > 1 ? fopen(arguments[1], "wb") : NULL;
    check(file != NULL && fwrite(rows, sizeof *rows, STEPS + 1, file) == STEPS + 1 && fclose(file) == 0);
    printf("%.4f\n", spent);
    return 0;
}
