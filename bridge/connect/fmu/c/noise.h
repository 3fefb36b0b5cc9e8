/* Noise as the twin's card has it: numpy's Philox 4x64 and its standard normal numbers, to the last bit. */
#ifndef NOISE_H
#define NOISE_H

#include <stdint.h>

typedef struct {
  uint64_t counter[4], key[2], buffer[4];
  int64_t used; /* of the buffer */
} stream;

/* A stream as numpy.random.Philox(key=seed, counter=[0, second, third, fourth]) begins. */
stream stream_of(uint64_t seed, uint64_t second, uint64_t third, uint64_t fourth);

/* The next standard normal number. */
double normal(stream *s);

#endif
