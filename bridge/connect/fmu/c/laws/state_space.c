/* z <- A z + B u, h = C z + D u: controller/state_space.py. The parameters are A, B, C and D, row after row. */
#include <string.h>

#include "common.h"

/* The sum of the products, as Python's `sum` makes it. */
static double dot(const double *left, const double *right, int n) {
  double sum = 0.0, lost = 0.0;
  for (int i = 0; i < n; i++) {
    double x = left[i] * right[i], total = sum + x;
#ifdef COMPENSATED_SUM
    if (i > 0) lost += fabs(sum) >= fabs(x) ? (sum - total) + x : (x - total) + sum;
#endif
    sum = total;
  }
  return lost != 0.0 && isfinite(lost) ? sum + lost : sum;
}

int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *parameters, double *memory, double *spool, double *signals) {
  (void)signals;
  const double *a = parameters, *b = a + STATES * STATES, *c = b + STATES * READS, *d = c + STATES;
  const double u[READS] = READINGS;
  double then[STATES + 1];
  double h = dot(c, memory, STATES) + dot(d, u, READS);
  for (int i = 0; i < STATES; i++) then[i] = dot(a + i * STATES, memory, STATES) + dot(b + i * READS, u, READS);
  memcpy(memory, then, STATES * sizeof *memory);
  *spool = saturated(compensated(h, facts->overlap), facts->limit);
  return 0;
}
