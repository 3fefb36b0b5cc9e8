/* The plant: blocks of the twin's own compiled step, commands that act after the delay, and the card. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "plant_data.h"

#define ROWS 1024 /* of noise from one beginning of its stream */
#define REAL_AT(m, at) ((m)->value[at].real)

static int run(own_state *o, int64_t steps) {
  return plant_block(o->parts, plant_whole, o->numbers, o->state, o->acting, steps, o->taps[0], o->seen);
}

static double converted(double reading, const range *r, const memory *m) {
  if (m->value[AT_QUANTISE].whole) reading = r->low + r->lsb * floor((reading - r->low) / r->lsb + 0.5);
  if (m->value[AT_CLIP].whole) {
    reading = reading > r->low ? reading : r->low;
    reading = reading < r->high ? reading : r->high;
  }
  return reading;
}

static double shifted(double value, double offset) { return offset != 0.0 ? value + offset : value; }

/* The scan of a tick: channel j of n is read at its end less (n-1-j) skews, noise of the card's own. */
static void scan(memory *m) {
  own_state *o = &m->own;
  int waiting = 0;
  for (int j = 0; j < CHANNELS; j++) waiting += plant_ranges[j].fitted;
  for (int j = 0; j < CHANNELS; j++) {
    const range *r = &plant_ranges[j];
    double noise = normal(&o->noise) * REAL_AT(m, AT_NOISE + 2 * j);
    if (!r->fitted) {
      REAL_AT(m, AT_MEASUREMENT + j) = NAN;
      continue;
    }
    waiting -= 1;
    double offset = REAL_AT(m, AT_OFFSET + 2 * j);
    double before = shifted(o->taps[0][j], offset), now = shifted(o->taps[1][j], offset);
    double value = now + waiting * SKEW / STEP * (before - now);
    REAL_AT(m, AT_MEASUREMENT + j) = converted(value + noise * r->lsb, r, m);
  }
}

static double touched(const memory *m, const source *s) {
  const own_state *o = &m->own;
  switch (s->kind) {
    case FROM_SEEN: return o->seen[s->place];
    case FROM_STATE: return o->state[s->place];
    case FROM_SUM: return o->state[s->place] + o->state[s->other];
    case FROM_SPEED: return (o->taps[1][s->place] - o->taps[0][s->place]) / STEP;
  }
#ifdef READS_FORCE
  double force;
  if (s->kind == FROM_FORCE && !plant_force(o->parts, o->state, o->taps[0], &force)) return force;
#endif
  return NAN;
}

static void scan_further(memory *m) {
  own_state *o = &m->own;
  for (int j = 0; j < FURTHER; j++) {
    const range *r = &further_ranges[j];
    double share = REAL_AT(m, AT_FURTHER_NOISE + 2 * j) * r->lsb;
    double added = normal(&o->own_noise[j]) * share + REAL_AT(m, AT_FURTHER_OFFSET + 2 * j);
    REAL_AT(m, AT_FURTHER + j) = converted(touched(m, &further_sources[j]) + added, r, m);
  }
}

static void tick(memory *m, int64_t now) {
  own_state *o = &m->own;
  int64_t number = now / DAQ;
  if (number % ROWS == 0) {
    uint64_t seed = (uint64_t)m->value[AT_SEED].whole, block = (uint64_t)(number / ROWS);
    o->noise = stream_of(seed, 0, 0, block);
    for (int j = 0; j < FURTHER; j++) o->own_noise[j] = stream_of(seed, further_sources[j].hash, 1, block);
  }
  scan(m);
  scan_further(m);
}

static void look(memory *m) {
  for (int i = 0; i < SEEN; i++) REAL_AT(m, AT_STATE + i) = m->own.seen[i];
}

static double put_out(const memory *m, double spool) {
  if (!m->value[AT_QUANTISE_OUTPUT].whole) return spool;
  double level = -1.0 + OUTPUT_LSB * floor((spool + 1.0) / OUTPUT_LSB + 0.5);
  return level < 1.0 - OUTPUT_LSB ? level : 1.0 - OUTPUT_LSB;
}

/* What has been set since the last step: numbers of the rig, and a command that acts after the delay. */
static int take(memory *m, char *words) {
  own_state *o = &m->own;
  if (!m->tuned) return OK;
  m->tuned = 0;
  plant_tune(m->value, o->parts);
  double spool = REAL_AT(m, AT_SPOOL);
  if (spool == o->told) return OK;
  if (o->waiting == PENDING) {
    snprintf(words, WORDS, "more than %d commands wait for loop.delay to pass", PENDING);
    return FAILED;
  }
  command *next = &o->pending[(o->first + o->waiting++) % PENDING];
  next->at = m->now + llround(REAL_AT(m, AT_DELAY) * 1e9);
  next->spool = o->told = spool;
  return OK;
}

void model_reset(memory *m) {
  own_state *o = &m->own;
  memcpy(o->parts, plant_parts, sizeof o->parts);
  memcpy(o->numbers, plant_numbers, sizeof o->numbers);
  memcpy(o->state, plant_state, sizeof o->state);
  run(o, 0);
  memcpy(o->taps[0], o->taps[1], sizeof o->taps[0]);
  o->acting = put_out(m, 0.0);
  look(m);
  tick(m, 0);
}

int model_begin(memory *m, char *words) {
  int64_t delay = llround(REAL_AT(m, AT_DELAY) * 1e9);
  if (delay % GRID) {
    snprintf(words, WORDS, "loop.delay = %.9g s: must be a whole number of steps of %.9g s", delay / 1e9, GRID / 1e9);
    return FAILED;
  }
  own_state *o = &m->own;
  plant_tune(m->value, o->parts);
  if (run(o, 0)) {
    snprintf(words, WORDS, "the circuit cannot start");
    return FAILED;
  }
  memcpy(o->taps[0], o->taps[1], sizeof o->taps[0]);
  o->acting = put_out(m, 0.0);
  look(m);
  tick(m, 0);
  return OK;
}

int model_step(memory *m, int64_t step, char *words) {
  own_state *o = &m->own;
  int64_t now = m->now, end = m->now + step;
  if (take(m, words) != OK) return FAILED;
  while (now < end) {
    int64_t stop = (now / DAQ + 1) * DAQ;
    while (o->waiting && o->pending[o->first].at <= now) {
      o->acting = put_out(m, o->pending[o->first].spool);
      o->first = (o->first + 1) % PENDING;
      o->waiting--;
    }
    if (o->waiting && o->pending[o->first].at < stop) stop = o->pending[o->first].at;
    if (end < stop) stop = end;
    if (run(o, (stop - now) / GRID)) {
      snprintf(words, WORDS, "the circuit cannot go on from t = %.9g s", m->begin + now / 1e9);
      return FAILED;
    }
    now = stop;
    if (now % DAQ == 0) tick(m, now);
  }
  look(m);
  return OK;
}
