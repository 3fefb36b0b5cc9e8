/* Philox 4x64 of ten rounds (Salmon et al., Parallel random numbers: as easy as 1, 2, 3, 2011), and the ziggurat of
 * numpy (Marsaglia and Tsang, 2000), whose tables are in `ziggurat.h`. */
#include "noise.h"

#include <math.h>

#include "ziggurat.h"

#define DRAWS 4

static void multiply(uint64_t a, uint64_t b, uint64_t *high, uint64_t *low) {
  unsigned __int128 product = (unsigned __int128)a * b;
  *high = (uint64_t)(product >> 64);
  *low = (uint64_t)product;
}

static void philox(const uint64_t counter[4], const uint64_t key[2], uint64_t out[4]) {
  uint64_t c[4] = {counter[0], counter[1], counter[2], counter[3]}, k0 = key[0], k1 = key[1];
  for (int round = 0; round < 10; round++) {
    uint64_t high0, low0, high1, low1;
    multiply(0xD2E7470EE14C6C93u, c[0], &high0, &low0);
    multiply(0xCA5A826395121157u, c[2], &high1, &low1);
    uint64_t next[4] = {high1 ^ c[1] ^ k0, low1, high0 ^ c[3] ^ k1, low0};
    for (int i = 0; i < 4; i++) c[i] = next[i];
    k0 += 0x9E3779B97F4A7C15u;
    k1 += 0xBB67AE8584CAA73Bu;
  }
  for (int i = 0; i < 4; i++) out[i] = c[i];
}

stream stream_of(uint64_t seed, uint64_t second, uint64_t third, uint64_t fourth) {
  stream s = {{0, second, third, fourth}, {seed, 0}, {0}, DRAWS};
  return s;
}

static uint64_t draw(stream *s) {
  if (s->used == DRAWS) {
    for (int i = 0; i < 4 && ++s->counter[i] == 0; i++) {
    }
    philox(s->counter, s->key, s->buffer);
    s->used = 0;
  }
  return s->buffer[s->used++];
}

static double uniform(stream *s) { return (double)(draw(s) >> 11) * (1.0 / 9007199254740992.0); }

static double tail(stream *s, uint64_t bits) {
  for (;;) {
    double x = -ZIGGURAT_INVERSE * log1p(-uniform(s)), y = -log1p(-uniform(s));
    if (y + y > x * x) return (bits >> 8) & 1 ? -(ZIGGURAT_EDGE + x) : ZIGGURAT_EDGE + x;
  }
}

double normal(stream *s) {
  for (;;) {
    uint64_t word = draw(s);
    int layer = (int)(word & 0xff);
    uint64_t bits = (word >> 9) & 0x000fffffffffffff;
    double x = (double)bits * ziggurat_width[layer];
    if ((word >> 8) & 1) x = -x;
    if (bits < ziggurat_inside[layer]) return x;
    if (layer == 0) return tail(s, bits);
    double height = (ziggurat_height[layer - 1] - ziggurat_height[layer]) * uniform(s) + ziggurat_height[layer];
    if (height < exp(-0.5 * x * x)) return x;
  }
}
