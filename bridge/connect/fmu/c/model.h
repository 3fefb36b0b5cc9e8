/* What the FMI functions and a model know of each other.
 *
 * A model is plant.c or controller.c. `data.h` is made for a scenario: its variables, sizes and numbers. All that
 * changes is one block of memory without pointers, so that a copy of it is the state of the FMU.
 */
#ifndef MODEL_H
#define MODEL_H

#include <stddef.h>
#include <stdint.h>

enum { REAL, WHOLE, TRUTH };                       /* types of variables */
enum { FIXED, TUNABLE, INPUT, OUTPUT, CONSTANT };  /* roles */
enum { OK, WARNING, DISCARD, FAILED };             /* as the status of FMI 2 and FMI 3 */
enum { MADE, INITIALIZING, RUNNING, ENDED };       /* phases */
enum { WORDS = 400 };                              /* characters of a message */

typedef union {
  double real;
  int64_t whole; /* of WHOLE and TRUTH */
} number;

typedef struct {
  const char *name;
  int type, role;
  double low, high; /* limits, SI */
  number start;
} variable;

#include "data.h"
#include OWN_STATE

typedef struct {
  int64_t phase;
  double begin;   /* start time of the experiment [s] */
  int64_t now;    /* since then [ns] */
  int64_t tuned;  /* have parameters or inputs changed since the model last looked? */
  number value[VARIABLES];
  own_state own;
} memory;

extern const variable variables[VARIABLES];

/* Put a fresh model in place; `value` holds the start values. */
void model_reset(memory *m);

/* The values that are known before the first step. Returns OK or FAILED with words. */
int model_begin(memory *m, char *words);

/* Advance by a step [ns] > 0, from m->now on, which the caller changes. Returns OK or FAILED with words. */
int model_step(memory *m, int64_t step, char *words);

#endif
