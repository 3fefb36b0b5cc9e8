/* What our laws have in common: the equations of controller/law.py, operation by operation. */
#ifndef COMMON_H
#define COMMON_H

#include <math.h>

#include "model.h"

#include "hydrotwin_law.h"

enum { KNOWN, POSITION, VELOCITY, OPENED, FIRST_OWN }; /* of the memory */

#define CLOSING 0.25 /* of the rest, at which a valve that has opened shuts again */

static double backward(const hydrotwin_sample *s, const double *memory, double period) {
  return memory[KNOWN] != 0.0 ? (s->position - memory[POSITION]) / period : 0.0;
}

/* Velocity of the piston [m/s] from the source that the scenario has chosen. */
static double velocity(const hydrotwin_sample *s, const double *memory, double filter_time, double period) {
#if defined(VELOCITY_MEASURED)
  (void)memory, (void)filter_time, (void)period;
  return s->velocity;
#elif defined(VELOCITY_BACKWARD)
  (void)filter_time;
  return backward(s, memory, period);
#else
  if (memory[KNOWN] == 0.0) return 0.0;
  double a = filter_time > 0.0 ? exp(-period / filter_time) : 0.0;
  return a * memory[VELOCITY] + (1.0 - a) * backward(s, memory, period);
#endif
}

static void remember(const hydrotwin_sample *s, double v, double *memory) {
  memory[KNOWN] = 1.0;
  memory[POSITION] = s->position;
  memory[VELOCITY] = v;
}

/* In this order of comparisons a NaN stays NaN instead of opening the valve fully. */
static double saturated(double u, double limit) {
  double least = limit < u ? limit : u;
  return -limit > least ? -limit : least;
}

static double sign(double u) { return fabs(u) > 0.0 ? copysign(1.0, u) : u; }

static double compensated(double u, double overlap) { return sign(u) * (overlap + (1.0 - overlap) * fabs(u)); }

/* The spool reference of h, the dead band jumped over, then saturated; with a rest the valve stays shut near h = 0. */
static double jumped(double h, double rest, const hydrotwin_facts *facts, double *memory) {
  double u = saturated(compensated(h, facts->overlap), facts->limit);
  if (rest == 0.0) {
    memory[OPENED] = 0.0;
    return u;
  }
  int opened = !(fabs(h) <= rest * (memory[OPENED] != 0.0 ? CLOSING : 1.0));
  memory[OPENED] = opened;
  return opened ? u : 0.0;
}

#endif
