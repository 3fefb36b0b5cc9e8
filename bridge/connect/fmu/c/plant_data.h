/* What is made for a scenario besides its variables: numbers of its circuit, and the compiled step. */
#ifndef PLANT_DATA_H
#define PLANT_DATA_H

#include "model.h"

typedef struct {
  double low, lsb, high; /* high: the greatest value that can be read */
  int fitted;
} range;

enum { FROM_SEEN, FROM_STATE, FROM_SUM, FROM_SPEED, FROM_FORCE };
typedef struct {
  int kind, place, other;
  uint64_t hash; /* of the name: begins its noise */
} source;

extern const double plant_parts[PARTS], plant_numbers[NUMBERS], plant_state[STATE];
extern const int64_t plant_whole[WHOLES];
extern const range plant_ranges[CHANNELS + 1], further_ranges[FURTHER + 1];
extern const source further_sources[FURTHER + 1];

/* Numbers of the rig that were set, into the circuit. */
void plant_tune(const number *value, double *parts);

/* The twin's compiled step, `twin.circuit.block.run_steps`; 0 when all went well. */
int plant_block(double *parts, const int64_t *whole, double *numbers, double *state, double reference, int64_t steps,
                double *taps, double *seen);

/* The force of the rod on its load, `twin.circuit.sensing.rod`; in the FMU only where a channel reads it. */
int plant_force(const double *parts, const double *state, const double *taps, double *force);

#endif
