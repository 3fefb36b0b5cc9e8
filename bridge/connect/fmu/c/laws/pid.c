/* PID whose integral does not wind up: controller/pid.py. */
#include "common.h"

enum { INTEGRAL = FIRST_OWN };

static double next_integral(double integral, double error, double w, const double *p, const hydrotwin_facts *facts) {
  if (isnan(w)) return integral;
  double room = facts->limit - facts->overlap, reach = (0.0 > room ? 0.0 : room) / (1.0 - facts->overlap);
  double beyond = w - saturated(w, reach), rate = p[OF_integral] * error;
#if defined(ANTI_WINDUP_CLAMPING)
  if (beyond * rate > 0.0) return integral;
#elif defined(ANTI_WINDUP_BACK_CALCULATION)
  rate -= beyond / p[OF_tracking_time];
#endif
  return integral + facts->sample_period * rate;
}

int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *p, double *memory, double *spool, double *signals) {
  (void)signals;
  double v = velocity(sample, memory, p[OF_filter_time], facts->sample_period);
  double error = target->position - sample->position;
  double w = p[OF_proportional] * error + memory[INTEGRAL] - p[OF_derivative] * v + p[OF_feed_forward] * target->velocity;
  *spool = jumped(w, p[OF_rest], facts, memory);
  remember(sample, v, memory);
  memory[INTEGRAL] = next_integral(memory[INTEGRAL], error, w, p, facts);
  return 0;
}
