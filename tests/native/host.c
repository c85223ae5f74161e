/* A small host: the bump with three FMI 2.0 FMUs in the order controller, seat, shaker. Prints the driver's
 * acceleration at every communication point. Libraries, GUIDs and value references stand in ports.h. */
#include "fmi2Functions.h"
#include "ports.h"

#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

typedef void (*Function)(void);

typedef struct {
    fmi2Component component;
    fmi2GetRealTYPE *get;
    fmi2SetRealTYPE *set;
    fmi2DoStepTYPE *step;
} Fmu;

static void demand(int fine, const char *what)
{
    if (!fine) {
        printf("failed: %s\n", what);
        exit(1);
    }
}

static Function find(const char *library, const char *name)
{
#ifdef _WIN32
    return (Function)GetProcAddress(LoadLibraryA(library), name);
#else
    Function function = NULL;
    *(void **)&function = dlsym(dlopen(library, RTLD_NOW), name);
    return function;
#endif
}

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    (void)environment, (void)status, (void)category;
    printf("%s: %s\n", name, message);
}

static Fmu start(const char *library, const char *guid)
{
    static const fmi2CallbackFunctions callbacks = {log_message, NULL, NULL, NULL, NULL};
    Fmu fmu;
    fmi2InstantiateTYPE *instantiate = (fmi2InstantiateTYPE *)find(library, "fmi2Instantiate");
    demand(instantiate != NULL, library);
    fmu.component = instantiate("instance", fmi2CoSimulation, guid, "", &callbacks, fmi2False, fmi2True);
    demand(fmu.component != NULL, "instantiate");
    fmu.get = (fmi2GetRealTYPE *)find(library, "fmi2GetReal");
    fmu.set = (fmi2SetRealTYPE *)find(library, "fmi2SetReal");
    fmu.step = (fmi2DoStepTYPE *)find(library, "fmi2DoStep");
    demand(((fmi2SetupExperimentTYPE *)find(library, "fmi2SetupExperiment"))(fmu.component, 0, 0, 0, 0, 0) == fmi2OK,
           "set up");
    demand(((fmi2EnterInitializationModeTYPE *)find(library, "fmi2EnterInitializationMode"))(fmu.component) == fmi2OK,
           "enter initialisation");
    return fmu;
}

static void end_initialisation(const char *library, Fmu fmu)
{
    demand(((fmi2ExitInitializationModeTYPE *)find(library, "fmi2ExitInitializationMode"))(fmu.component) == fmi2OK,
           "exit initialisation");
}

static void pass(Fmu from, const fmi2ValueReference *outputs, Fmu to, const fmi2ValueReference *inputs, size_t count)
{
    double values[4];
    demand(from.get(from.component, outputs, count, values) == fmi2OK, "get");
    demand(to.set(to.component, inputs, count, values) == fmi2OK, "set");
}

int main(void)
{
    const fmi2ValueReference floor_out[] = {Shaker_floor_displacement, Shaker_floor_velocity,
                                            Shaker_floor_acceleration};
    const fmi2ValueReference floor_in[] = {SeatPlant_floor_displacement, SeatPlant_floor_velocity,
                                           SeatPlant_floor_acceleration};
    const fmi2ValueReference sensed[] = {SeatPlant_seat_acceleration_measured,
                                         SeatPlant_suspension_deflection_measured};
    const fmi2ValueReference felt[] = {SeatController_seat_acceleration, SeatController_suspension_deflection};
    const fmi2ValueReference force_out[] = {SeatController_force}, force_in[] = {SeatPlant_force};
    const fmi2ValueReference driver[] = {SeatPlant_driver_acceleration};
    const double h = 0.002;
    const Fmu shaker = start(Shaker_library, Shaker_guid), seat = start(SeatPlant_library, SeatPlant_guid);
    const Fmu controller = start(SeatController_library, SeatController_guid);
    pass(shaker, floor_out, seat, floor_in, 3);
    end_initialisation(Shaker_library, shaker);
    end_initialisation(SeatPlant_library, seat);
    end_initialisation(SeatController_library, controller);
    for (int k = 0; k <= 1500; ++k) {
        double acceleration = 0.0;
        demand(seat.get(seat.component, driver, 1, &acceleration) == fmi2OK, "get");
        printf("%.17g\n", acceleration);
        pass(seat, sensed, controller, felt, 2);
        demand(controller.step(controller.component, k * h, h, fmi2True) == fmi2OK, "step of the controller");
        pass(controller, force_out, seat, force_in, 1);
        pass(shaker, floor_out, seat, floor_in, 3);
        demand(seat.step(seat.component, k * h, h, fmi2True) == fmi2OK, "step of the seat");
        demand(shaker.step(shaker.component, k * h, h, fmi2True) == fmi2OK, "step of the shaker");
    }
    return 0;
}
