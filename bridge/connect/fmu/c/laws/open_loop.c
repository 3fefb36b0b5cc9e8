/* The target is the spool reference itself: controller/law.py, `open_loop`. */
#include "common.h"

int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *parameters, double *memory, double *spool, double *signals) {
  (void)sample, (void)parameters, (void)memory, (void)signals;
  *spool = saturated(target->position, facts->limit);
  return 0;
}
