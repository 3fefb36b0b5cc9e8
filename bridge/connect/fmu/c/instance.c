/* An instance of the FMU, whatever the version of FMI. */
#include "instance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NS 1e9
#define NEAR 0.01 /* [ns], what rounding may take from a time */

static int says(instance *self, int status, const char *words) {
  if (status != OK && self->tell) self->tell(self, status, words);
  return status;
}

int instance_fails(instance *self, const char *words) { return says(self, FAILED, words); }

instance *instance_made(const char *name, const char *token) {
  if (!token || strcmp(token, TOKEN)) return 0;
  instance *self = calloc(1, sizeof *self);
  if (!self) return 0;
  size_t length = name ? strlen(name) : 0;
  self->name = calloc(1, length + 1);
  if (!self->name) {
    free(self);
    return 0;
  }
  if (length) memcpy(self->name, name, length);
  instance_reset(self);
  return self;
}

void instance_freed(instance *self) {
  if (!self) return;
  free(self->name);
  free(self);
}

int instance_reset(instance *self) {
  memset(&self->m, 0, sizeof self->m);
  for (int i = 0; i < VARIABLES; i++) self->m.value[i] = variables[i].start;
  model_reset(&self->m);
  return OK;
}

int instance_initialize(instance *self, double begin) {
  if (self->m.phase != MADE) return instance_fails(self, "it is initialised already; reset it first");
  if (!isfinite(begin)) return instance_fails(self, "the start time is not a number");
  self->m.begin = self->m.value[AT_TIME].real = begin;
  self->m.phase = INITIALIZING;
  return OK;
}

int instance_run(instance *self) {
  char words[WORDS] = "";
  if (self->m.phase != INITIALIZING) return instance_fails(self, "it is not being initialised");
  int status = model_begin(&self->m, words);
  if (status < FAILED) self->m.phase = RUNNING;
  return says(self, status, words);
}

int instance_end(instance *self) {
  if (self->m.phase != RUNNING) return instance_fails(self, "it does not run, so it cannot be terminated");
  self->m.phase = ENDED;
  return OK;
}

int instance_step(instance *self, double time, double step) {
  char words[WORDS] = "";
  memory *m = &self->m;
  if (m->phase != RUNNING) return instance_fails(self, "it is not initialised, so it cannot step");
  double there = (time - m->begin) * NS, long_ns = step * NS;
  double slack = 0.5 + fabs(time) * NS * 1e-15; /* of a time that was summed up */
  if (!(fabs(there - (double)m->now) < slack)) {
    snprintf(words, WORDS, "asked to step from t = %.9g s, but it stands at %.9g s", time, m->begin + m->now / NS);
    return instance_fails(self, words);
  }
  if (!(long_ns > 0.0 && long_ns < 9e18)) {
    snprintf(words, WORDS, "a communication step of %g s: must be greater than 0", step);
    return instance_fails(self, words);
  }
  int64_t whole = llround(long_ns);
  if (fabs(long_ns - (double)whole) > NEAR || whole % GRID) {
    int64_t below = whole / GRID;
    snprintf(words, WORDS, "a communication step of %.9g s is not a whole number of steps of %.9g s; nearest: %.9g or %.9g s",
             step, GRID / NS, (below ? below : 1) * GRID / NS, (below + 1) * GRID / NS);
    return instance_fails(self, words);
  }
  int status = model_step(m, whole, words);
  if (status < FAILED) m->now += whole;
  m->value[AT_TIME].real = m->begin + m->now / NS;
  return says(self, status, words);
}

static int may_be_set(const variable *v, int64_t phase) {
  if (phase == MADE || phase == INITIALIZING) return v->role == FIXED || v->role == TUNABLE || v->role == INPUT;
  return v->role == TUNABLE || v->role == INPUT;
}

int instance_set(instance *self, uint32_t reference, int type, number value) {
  char words[WORDS];
  if (reference >= VARIABLES || variables[reference].type != type)
    return instance_fails(self, "there is no variable of this value reference and type");
  const variable *v = &variables[reference];
  if (!may_be_set(v, self->m.phase)) {
    snprintf(words, WORDS, "%s cannot be set %s", v->name,
             v->role == FIXED ? "once it runs: it is fixed" : "at all: it is an output or a constant");
    return instance_fails(self, words);
  }
  double seen = type == REAL ? value.real : (double)value.whole;
  if (!(seen >= v->low && seen <= v->high)) {
    snprintf(words, WORDS, "%s = %g: must be within %g and %g; %g stays", v->name, seen, v->low, v->high,
             type == REAL ? self->m.value[reference].real : (double)self->m.value[reference].whole);
    return says(self, v->role == INPUT ? WARNING : DISCARD, words);
  }
  self->m.value[reference] = value;
  self->m.tuned = 1;
  return OK;
}

int instance_get(instance *self, uint32_t reference, int type, number *value) {
  if (reference >= VARIABLES || variables[reference].type != type)
    return instance_fails(self, "there is no variable of this value reference and type");
  *value = self->m.value[reference];
  return OK;
}

int instance_save(instance *self, void **saved) {
  if (!*saved) *saved = malloc(sizeof self->m);
  if (!*saved) return instance_fails(self, "there is no memory for a copy of its state");
  memcpy(*saved, &self->m, sizeof self->m);
  return OK;
}

int instance_restore(instance *self, const void *saved) {
  if (!saved) return instance_fails(self, "there is no state to go back to");
  memcpy(&self->m, saved, sizeof self->m);
  return OK;
}

#define SEAL sizeof TOKEN /* written before a state: that of another FMU is refused */

size_t instance_size(void) { return SEAL + sizeof(memory); }

int instance_write(instance *self, const void *saved, void *bytes, size_t size) {
  if (!saved || size < instance_size()) return instance_fails(self, "too little room for its state");
  memcpy(bytes, TOKEN, SEAL);
  memcpy((char *)bytes + SEAL, saved, sizeof(memory));
  return OK;
}

int instance_read(instance *self, const void *bytes, size_t size, void **saved) {
  if (size < instance_size() || memcmp(bytes, TOKEN, SEAL))
    return instance_fails(self, "these bytes are not a state of this FMU");
  if (!*saved) *saved = malloc(sizeof(memory));
  if (!*saved) return instance_fails(self, "there is no memory for its state");
  memcpy(*saved, (const char *)bytes + SEAL, sizeof(memory));
  return OK;
}
