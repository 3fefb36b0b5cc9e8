/* The whole limit in the direction of (x_ref - x) - T_d v: controller/law.py, `relay`. */
#include "common.h"

int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *parameters, double *memory, double *spool, double *signals) {
  (void)signals;
  double v = velocity(sample, memory, parameters[OF_filter_time], facts->sample_period);
  double h = target->position - sample->position - parameters[OF_derivative_time] * v;
  remember(sample, v, memory);
  *spool = facts->limit * sign(h);
  return 0;
}
