/* FMI 2.0 for co-simulation. */
#include "fmi/fmi2Functions.h"
#include "instance.h"

#include <stdlib.h>
#include <string.h>

static void tell(instance *self, int status, const char *words) {
  const fmi2CallbackFunctions *callbacks = self->callbacks;
  if (callbacks && callbacks->logger)
    callbacks->logger(callbacks->componentEnvironment, self->name, (fmi2Status)status,
                      status == WARNING ? "logStatusWarning" : "logStatusError", "%s", words);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
  (void)c, (void)on, (void)n, (void)categories; /* only refusals are logged, and always */
  return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type kind, fmi2String token, fmi2String resources,
                              const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging) {
  (void)resources, (void)visible, (void)logging;
  instance *self = kind == fmi2CoSimulation ? instance_made(name, token) : 0;
  if (!self) {
    if (callbacks && callbacks->logger)
      callbacks->logger(callbacks->componentEnvironment, name, fmi2Error, "logStatusError", "%s",
                        kind == fmi2CoSimulation ? "the guid is that of another FMU" : "it is for co-simulation only");
    return 0;
  }
  self->callbacks = (void *)callbacks;
  self->tell = tell;
  return self;
}

void fmi2FreeInstance(fmi2Component c) { instance_freed(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real begin,
                               fmi2Boolean has_end, fmi2Real end) {
  (void)has_tolerance, (void)tolerance, (void)has_end, (void)end; /* the step is fixed */
  ((instance *)c)->m.begin = begin;
  return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return (fmi2Status)instance_initialize(c, ((instance *)c)->m.begin);
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return (fmi2Status)instance_run(c); }
fmi2Status fmi2Terminate(fmi2Component c) { return (fmi2Status)instance_end(c); }
fmi2Status fmi2Reset(fmi2Component c) { return (fmi2Status)instance_reset(c); }

#define GET(NAME, VALUE, TYPE, FIELD)                                                                     \
  fmi2Status fmi2Get##NAME(fmi2Component c, const fmi2ValueReference at[], size_t n, VALUE values[]) {    \
    int worst = OK;                                                                                       \
    for (size_t i = 0; i < n; i++) {                                                                      \
      number found = {0};                                                                                 \
      int status = instance_get(c, at[i], TYPE, &found);                                                  \
      if (status > worst) worst = status;                                                                 \
      values[i] = (VALUE)found.FIELD;                                                                     \
    }                                                                                                     \
    return (fmi2Status)worst;                                                                             \
  }
#define SET(NAME, VALUE, TYPE, FIELD)                                                                        \
  fmi2Status fmi2Set##NAME(fmi2Component c, const fmi2ValueReference at[], size_t n, const VALUE values[]) { \
    int worst = OK;                                                                                          \
    for (size_t i = 0; i < n; i++) {                                                                         \
      number value = {.FIELD = values[i]};                                                                   \
      int status = instance_set(c, at[i], TYPE, value);                                                      \
      if (status > worst) worst = status;                                                                    \
    }                                                                                                        \
    return (fmi2Status)worst;                                                                                \
  }
GET(Real, fmi2Real, REAL, real)
SET(Real, fmi2Real, REAL, real)
GET(Integer, fmi2Integer, WHOLE, whole)
SET(Integer, fmi2Integer, WHOLE, whole)
GET(Boolean, fmi2Boolean, TRUTH, whole)
SET(Boolean, fmi2Boolean, TRUTH, whole)

static fmi2Status none(fmi2Component c, size_t n) {
  return n ? (fmi2Status)instance_fails(c, "it has no such variables") : fmi2OK;
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2String values[]) {
  (void)at, (void)values;
  return none(c, n);
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2String values[]) {
  (void)at, (void)values;
  return none(c, n);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) { return (fmi2Status)instance_save(c, state); }
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) { return (fmi2Status)instance_restore(c, state); }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
  (void)c;
  if (state) {
    free(*state);
    *state = 0;
  }
  return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
  (void)c, (void)state;
  *size = instance_size();
  return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return (fmi2Status)instance_write(c, state, bytes, size);
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
  return (fmi2Status)instance_read(c, bytes, size, state);
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
                                        const fmi2ValueReference known[], size_t m, const fmi2Real dv[], fmi2Real dz[]) {
  (void)unknown, (void)n, (void)known, (void)m, (void)dv, (void)dz;
  return (fmi2Status)instance_fails(c, "it gives no derivatives");
}
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference at[], size_t n,
                                       const fmi2Integer order[], const fmi2Real values[]) {
  (void)at, (void)order, (void)values;
  return none(c, n);
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference at[], size_t n,
                                        const fmi2Integer order[], fmi2Real values[]) {
  (void)at, (void)order, (void)values;
  return none(c, n);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean never_back) {
  (void)never_back;
  return (fmi2Status)instance_step(c, time, step);
}
fmi2Status fmi2CancelStep(fmi2Component c) { return (fmi2Status)instance_fails(c, "no step is under way"); }

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard; /* no step is ever pending */
}
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
  const memory *m = &((instance *)c)->m;
  if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
  *value = m->begin + (double)m->now * 1e-9;
  return fmi2OK;
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
  (void)c;
  if (kind != fmi2Terminated) return fmi2Discard;
  *value = fmi2False;
  return fmi2OK;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
  (void)c, (void)kind, (void)value;
  return fmi2Discard;
}
