/* A co-simulation host that is not Python: a plant and a controller FMU of ours, coupled, their values in hexadecimal.
 *
 * Standard input: "plant.so token law.so token step_in_s steps", then lines "plant law" of value references that
 * connect a measurement with an input of the law until "end"; "spool output, spool input"; lines "step reference value"
 * of inputs of the law until "end"; value references of the plant that are printed until "end". Each step the law
 * steps before the plant. Half way the plant's state is saved, the step made, the state restored and the step made
 * again: what is printed tells whether that is the same.
 */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef FMI3
#include "fmi3Functions.h"
typedef fmi3Instance component;
#define NAME(f) "fmi3" #f
#else
#include "fmi2Functions.h"
typedef fmi2Component component;
#define NAME(f) "fmi2" #f
#endif

enum { MOST = 100000 };
typedef struct {
  void *library;
  component c;
} fmu;

static void check(int status, const char *what) {
  if (status > 1) {
    fprintf(stderr, "%s returned %d\n", what, status);
    exit(1);
  }
}

static void *find(fmu *f, const char *name) {
  void *found = dlsym(f->library, name);
  if (!found) check(99, name);
  return found;
}

#ifdef FMI3
static void tell(fmi3InstanceEnvironment e, fmi3Status status, fmi3String category, fmi3String words) {
  (void)e, (void)category;
  fprintf(stderr, "%d: %s\n", status, words);
}
static void start(fmu *f, const char *token) {
  f->c = ((fmi3InstantiateCoSimulationTYPE *)find(f, NAME(InstantiateCoSimulation)))("a", token, "", 0, 0, 0, 0, 0, 0, 0,
                                                                                     tell, 0);
  if (!f->c) exit(2);
  check(((fmi3EnterInitializationModeTYPE *)find(f, NAME(EnterInitializationMode)))(f->c, 0, 0, 0, 0, 0), "enter");
  check(((fmi3ExitInitializationModeTYPE *)find(f, NAME(ExitInitializationMode)))(f->c), "exit");
}
static void step(fmu *f, double t, double h) {
  fmi3Boolean event, terminate, early;
  double reached;
  check(((fmi3DoStepTYPE *)find(f, NAME(DoStep)))(f->c, t, h, 0, &event, &terminate, &early, &reached), "step");
}
static double get(fmu *f, unsigned at) {
  double value;
  check(((fmi3GetFloat64TYPE *)find(f, NAME(GetFloat64)))(f->c, &at, 1, &value, 1), "get");
  return value;
}
static void set(fmu *f, unsigned at, double value) {
  check(((fmi3SetFloat64TYPE *)find(f, NAME(SetFloat64)))(f->c, &at, 1, &value, 1), "set");
}
#define GET_STATE "fmi3GetFMUState"
#define SET_STATE "fmi3SetFMUState"
typedef fmi3GetFMUStateTYPE get_state;
typedef fmi3SetFMUStateTYPE set_state;
#else
static void tell(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category, fmi2String words,
                 ...) {
  va_list rest;
  (void)e, (void)name, (void)category, (void)status;
  va_start(rest, words);
  vfprintf(stderr, words, rest);
  va_end(rest);
}
static const fmi2CallbackFunctions callbacks = {tell, calloc, free, 0, 0};
static void start(fmu *f, const char *token) {
  f->c = ((fmi2InstantiateTYPE *)find(f, NAME(Instantiate)))("a", fmi2CoSimulation, token, "", &callbacks, 0, 0);
  if (!f->c) exit(2);
  check(((fmi2SetupExperimentTYPE *)find(f, NAME(SetupExperiment)))(f->c, 0, 0, 0, 0, 0), "setup");
  check(((fmi2EnterInitializationModeTYPE *)find(f, NAME(EnterInitializationMode)))(f->c), "enter");
  check(((fmi2ExitInitializationModeTYPE *)find(f, NAME(ExitInitializationMode)))(f->c), "exit");
}
static void step(fmu *f, double t, double h) {
  check(((fmi2DoStepTYPE *)find(f, NAME(DoStep)))(f->c, t, h, 0), "step");
}
static double get(fmu *f, unsigned at) {
  double value;
  check(((fmi2GetRealTYPE *)find(f, NAME(GetReal)))(f->c, &at, 1, &value), "get");
  return value;
}
static void set(fmu *f, unsigned at, double value) {
  check(((fmi2SetRealTYPE *)find(f, NAME(SetReal)))(f->c, &at, 1, &value), "set");
}
#define GET_STATE "fmi2GetFMUstate"
#define SET_STATE "fmi2SetFMUstate"
typedef fmi2GetFMUstateTYPE get_state;
typedef fmi2SetFMUstateTYPE set_state;
#endif

typedef struct {
  long at;
  unsigned to;
  double value;
} change;

int main(void) {
  static char path[2][1000], token[2][100];
  static unsigned from[MOST], to[MOST], shown[MOST], out, in;
  static change changes[MOST];
  long steps, wired = 0, watched = 0, planned = 0, next = 0;
  double h;
  fmu own[2], *plant = &own[0], *law = &own[1];
  if (scanf("%999s %99s %999s %99s %lf %ld", path[0], token[0], path[1], token[1], &h, &steps) != 6) return 3;
  while (scanf("%u %u", &from[wired], &to[wired]) == 2) wired++;
  if (scanf(" end %u %u", &out, &in) != 2) return 3;
  while (scanf("%ld %u %lf", &changes[planned].at, &changes[planned].to, &changes[planned].value) == 3) planned++;
  if (scanf(" end") < 0) return 3;
  while (scanf("%u", &shown[watched]) == 1) watched++;
  for (int i = 0; i < 2; i++) {
    own[i].library = dlopen(path[i], RTLD_NOW | RTLD_GLOBAL);
    if (!own[i].library) return fprintf(stderr, "%s\n", dlerror()), 4;
    start(&own[i], token[i]);
  }
  for (long k = 0; k <= steps; k++) {
    for (long j = 0; j < watched; j++) printf("%a ", get(plant, shown[j]));
    printf("%a\n", get(law, out));
    if (k == steps) break;
    for (; next < planned && changes[next].at == k; next++) set(law, changes[next].to, changes[next].value);
    for (long j = 0; j < wired; j++) set(law, to[j], get(plant, from[j]));
    step(law, k * h, h);
    set(plant, in, get(law, out));
    if (k == steps / 2) {
      void *saved = 0;
      check(((get_state *)find(plant, GET_STATE))(plant->c, (void *)&saved), "get state");
      step(plant, k * h, h);
      check(((set_state *)find(plant, SET_STATE))(plant->c, saved), "set state");
    }
    step(plant, k * h, h);
  }
  return 0;
}
