/* What the plant keeps between steps. */
#ifndef PLANT_H
#define PLANT_H

#include "noise.h"

typedef struct {
  int64_t at; /* [ns] */
  double spool;
} command;

typedef struct {
  double parts[PARTS], numbers[NUMBERS], state[STATE]; /* the circuit, its lines, and where they are */
  double taps[2][CHANNELS], seen[SEEN];                /* what a block fills */
  double told, acting;                                 /* spool reference: the newest, and the one in force */
  command pending[PENDING];                            /* a ring: told, but not acting yet */
  int64_t first, waiting;
  stream noise, own_noise[FURTHER + 1];
} own_state;

#endif
