/* The controller: a law as hydrotwin_law.h declares it, asked at each sampling instant, its answer held between them. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model.h"

#include "hydrotwin_law.h"

#define REAL_AT(m, at) ((m)->value[at].real)

void model_reset(memory *m) { memset(&m->own, 0, sizeof m->own); }

static int64_t ns(const memory *m, int at) { return llround(REAL_AT(m, at) * 1e9); }

int model_begin(memory *m, char *words) {
  if (ns(m, AT_SAMPLE_PERIOD) > 0) return OK;
  snprintf(words, WORDS, "loop.sample_period = %g s: must be at least 1e-9 s", REAL_AT(m, AT_SAMPLE_PERIOD));
  return FAILED;
}

static int answer(memory *m, int64_t stamp, char *words) {
  own_state *o = &m->own;
  double parameters[PARAMETERS + 1], channels[FURTHER + 1], signals[SIGNALS + 1], spool = NAN;
  for (int i = 0; i < PARAMETERS; i++) parameters[i] = REAL_AT(m, AT_PARAMETERS + i);
  for (int i = 0; i < FURTHER; i++) channels[i] = REAL_AT(m, AT_FURTHER + i);
  for (int i = 0; i < SIGNALS; i++) signals[i] = REAL_AT(m, AT_SIGNALS + i);
  const hydrotwin_facts facts = {REAL_AT(m, AT_SAMPLE_PERIOD), REAL_AT(m, AT_LIMIT), REAL_AT(m, AT_OVERLAP)};
  const hydrotwin_sample sample = {stamp, REAL_AT(m, AT_SAMPLE), REAL_AT(m, AT_SAMPLE + 1), REAL_AT(m, AT_SAMPLE + 2),
                                   REAL_AT(m, AT_SAMPLE + 3), REAL_AT(m, AT_SAMPLE + 4), FURTHER ? channels : 0};
  const hydrotwin_target target = {REAL_AT(m, AT_TARGET), REAL_AT(m, AT_TARGET + 1)};
  int returned = 0;
#ifdef LAW_HAS_INIT
  if (!o->begun) returned = hydrotwin_law_init(&facts, parameters, o->memory);
#endif
  o->begun = 1;
  if (!returned) returned = hydrotwin_law(&sample, &target, &facts, parameters, o->memory, &spool, signals);
  if (returned || !isfinite(spool)) {
    snprintf(words, WORDS, "the law returned %d and the spool reference %g at t = %.9g s", returned, spool, stamp / 1e9);
    return FAILED;
  }
  REAL_AT(m, AT_SPOOL) = spool;
  for (int i = 0; i < SIGNALS; i++) REAL_AT(m, AT_SIGNALS + i) = signals[i];
  return OK;
}

int model_step(memory *m, int64_t step, char *words) {
  int64_t period = ns(m, AT_SAMPLE_PERIOD), offset = ns(m, AT_SAMPLE_OFFSET);
  int64_t now = llround(m->begin * 1e9) + m->now, end = now + step;
  int64_t stamp = now <= offset ? offset : offset + (now - offset + period - 1) / period * period;
  for (; stamp < end; stamp += period)
    if (answer(m, stamp, words) != OK) return FAILED;
  return OK;
}
