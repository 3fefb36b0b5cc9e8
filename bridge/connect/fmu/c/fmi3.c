/* FMI 3.0 for co-simulation. */
#include "fmi/fmi3Functions.h"
#include "instance.h"

#include <stdlib.h>

typedef fmi3ValueReference reference;

static void tell(instance *self, int status, const char *words) {
  fmi3LogMessageCallback log = (fmi3LogMessageCallback)self->callbacks;
  if (log) log(self->environment, (fmi3Status)status, status == WARNING ? "logStatusWarning" : "logStatusError", words);
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
  (void)c, (void)on, (void)n, (void)categories; /* only refusals are logged, and always */
  return fmi3OK;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const reference required[], size_t n, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update) {
  (void)resources, (void)visible, (void)logging, (void)early, (void)required, (void)n, (void)update;
  instance *self = events ? 0 : instance_made(name, token);
  if (!self) {
    if (log)
      log(environment, fmi3Error, "logStatusError",
          events ? "it has no event mode" : "the instantiation token is that of another FMU");
    return 0;
  }
  self->callbacks = (void *)log;
  self->environment = environment;
  self->tell = tell;
  return self;
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
  (void)name, (void)token, (void)resources, (void)visible, (void)logging;
  if (log) log(environment, fmi3Error, "logStatusError", "it is for co-simulation only");
  return 0;
}
fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock) {
  (void)update, (void)lock, (void)unlock;
  return fmi3InstantiateModelExchange(name, token, resources, visible, logging, environment, log);
}

void fmi3FreeInstance(fmi3Instance c) { instance_freed(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 begin, fmi3Boolean has_end, fmi3Float64 end) {
  (void)has_tolerance, (void)tolerance, (void)has_end, (void)end; /* the step is fixed */
  return (fmi3Status)instance_initialize(c, begin);
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return (fmi3Status)instance_run(c); }
fmi3Status fmi3Terminate(fmi3Instance c) { return (fmi3Status)instance_end(c); }
fmi3Status fmi3Reset(fmi3Instance c) { return (fmi3Status)instance_reset(c); }

#define GET(NAME, TYPE, FIELD)                                                                                        \
  fmi3Status fmi3Get##NAME(fmi3Instance c, const reference at[], size_t n, fmi3##NAME values[], size_t room) {        \
    int worst = n == room ? OK : instance_fails(c, "as many values as value references are asked for, all are scalars"); \
    for (size_t i = 0; i < n && i < room; i++) {                                                                      \
      number found = {0};                                                                                             \
      int status = instance_get(c, at[i], TYPE, &found);                                                              \
      if (status > worst) worst = status;                                                                             \
      values[i] = (fmi3##NAME)found.FIELD;                                                                            \
    }                                                                                                                 \
    return (fmi3Status)worst;                                                                                         \
  }
#define SET(NAME, TYPE, FIELD)                                                                                        \
  fmi3Status fmi3Set##NAME(fmi3Instance c, const reference at[], size_t n, const fmi3##NAME values[], size_t room) {  \
    int worst = n == room ? OK : instance_fails(c, "as many values as value references are given, all are scalars");  \
    for (size_t i = 0; i < n && i < room; i++) {                                                                      \
      number value = {.FIELD = values[i]};                                                                            \
      int status = instance_set(c, at[i], TYPE, value);                                                               \
      if (status > worst) worst = status;                                                                             \
    }                                                                                                                 \
    return (fmi3Status)worst;                                                                                         \
  }
GET(Float64, REAL, real)
SET(Float64, REAL, real)
GET(Int64, WHOLE, whole)
SET(Int64, WHOLE, whole)
GET(Boolean, TRUTH, whole)
SET(Boolean, TRUTH, whole)

static fmi3Status none(fmi3Instance c, size_t n) {
  return n ? (fmi3Status)instance_fails(c, "it has no such variables") : fmi3OK;
}
#define NONE(NAME)                                                                                                   \
  fmi3Status fmi3Get##NAME(fmi3Instance c, const reference at[], size_t n, fmi3##NAME values[], size_t room) {       \
    (void)at, (void)values, (void)room;                                                                              \
    return none(c, n);                                                                                               \
  }                                                                                                                  \
  fmi3Status fmi3Set##NAME(fmi3Instance c, const reference at[], size_t n, const fmi3##NAME values[], size_t room) { \
    (void)at, (void)values, (void)room;                                                                              \
    return none(c, n);                                                                                               \
  }
NONE(Float32)
NONE(Int8)
NONE(UInt8)
NONE(Int16)
NONE(UInt16)
NONE(Int32)
NONE(UInt32)
NONE(UInt64)
NONE(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const reference at[], size_t n, size_t sizes[], fmi3Binary values[], size_t m) {
  (void)at, (void)sizes, (void)values, (void)m;
  return none(c, n);
}
fmi3Status fmi3SetBinary(fmi3Instance c, const reference at[], size_t n, const size_t sizes[], const fmi3Binary values[],
                         size_t m) {
  (void)at, (void)sizes, (void)values, (void)m;
  return none(c, n);
}
fmi3Status fmi3GetClock(fmi3Instance c, const reference at[], size_t n, fmi3Clock values[]) {
  (void)at, (void)values;
  return none(c, n);
}
fmi3Status fmi3SetClock(fmi3Instance c, const reference at[], size_t n, const fmi3Clock values[]) {
  (void)at, (void)values;
  return none(c, n);
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) { return (fmi3Status)instance_save(c, state); }
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) { return (fmi3Status)instance_restore(c, state); }
fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
  (void)c;
  if (state) {
    free(*state);
    *state = 0;
  }
  return fmi3OK;
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
  (void)c, (void)state;
  *size = instance_size();
  return fmi3OK;
}
fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
  return (fmi3Status)instance_write(c, state, bytes, size);
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
  return (fmi3Status)instance_read(c, bytes, size, state);
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean never_back, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached) {
  (void)never_back;
  int status = instance_step(c, time, step);
  const memory *m = &((instance *)c)->m;
  if (event) *event = fmi3False;
  if (terminate) *terminate = fmi3False;
  if (early) *early = fmi3False;
  if (reached) *reached = m->begin + (double)m->now * 1e-9;
  return (fmi3Status)status;
}
