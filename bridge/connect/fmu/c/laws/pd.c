/* In proportion to the error, less the piston's velocity: controller/law.py, `pd`. */
#include "common.h"

int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *parameters, double *memory, double *spool, double *signals) {
  (void)signals;
  double v = velocity(sample, memory, parameters[OF_filter_time], facts->sample_period);
  double h = parameters[OF_proportional] * (target->position - sample->position) - parameters[OF_derivative] * v;
  remember(sample, v, memory);
  *spool = jumped(h, parameters[OF_rest], facts, memory);
  return 0;
}
