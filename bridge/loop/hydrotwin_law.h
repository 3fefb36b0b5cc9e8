/* hydrotwin_law.h: a control law in C, for scenarios with controller.kind = "c".

   The law is called once per sampling period. All quantities are SI, pressures are gauge; a positive spool reference
   lifts the piston. All that a law remembers belongs into `memory`. Variables that are static are new for each run, and
   whenever the memory is.

   Give the C file as controller.source, or compile it (cc -O2 -fPIC -shared law.c -o law.so) and give the library as
   controller.library. `hydrotwin messages --c` prints this file. */

#ifndef HYDROTWIN_LAW_H
#define HYDROTWIN_LAW_H

#include <stdint.h>

#define HYDROTWIN_LAW_VERSION 1 /* of what follows */

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/* What the card read at a sampling instant. */
typedef struct {
  int64_t stamp;   /* [ns] of simulated time since the start of the run */
  double position; /* [m] */
  double velocity; /* [m/s], tachometer; NaN when absent */
  double p1;       /* [Pa], before the relief valve */
  double p2;       /* [Pa], lower chamber */
  double p3;       /* [Pa], upper chamber */
  const double *channels; /* further channels of the card, SI, in the order of hydrotwin_law_channels; 0 without */
} hydrotwin_sample;

/* What is wanted at that instant. */
typedef struct {
  double position; /* [m] */
  double velocity; /* [m/s] */
} hydrotwin_target;

/* What the scenario says of the loop; the same in every call. */
typedef struct {
  double sample_period; /* [s], > 0 */
  double limit;         /* of the spool reference, 0 to 1 */
  double overlap;       /* of the valve's lands to jump over, 0 to 1; 0 without controller.compensate_overlap */
} hydrotwin_facts;

/* A number that the law logs. */
typedef struct {
  const char *name; /* letters, digits and _ */
  const char *unit; /* such as "m/s"; "" for none */
} hydrotwin_signal;

/* REQUIRED: const int32_t hydrotwin_law_version = HYDROTWIN_LAW_VERSION; */
extern const int32_t hydrotwin_law_version;

/* REQUIRED: the law. Sets *spool, -1 to 1, and returns 0; any other number ends the run as failed.
   parameters: in the order of hydrotwin_law_parameters. memory: hydrotwin_law_memory numbers, 0.0 at the first sample.
   signals: where to put the values of hydrotwin_law_signals. */
int hydrotwin_law(const hydrotwin_sample *sample, const hydrotwin_target *target, const hydrotwin_facts *facts,
                  const double *parameters, double *memory, double *spool, double *signals);

/* How many numbers the law remembers. Without it none. */
extern const int32_t hydrotwin_law_memory;

/* Names of the parameters, then 0: const char *const hydrotwin_law_parameters[] = {"kp", "ki", 0};
   the scenario gives each of them in [controller.parameters]. Without it there are none. */
extern const char *const hydrotwin_law_parameters[];

/* What the law logs: const hydrotwin_signal hydrotwin_law_signals[] = {{"integral", "m s"}, {0, 0}};
   Without it nothing. */
extern const hydrotwin_signal hydrotwin_law_signals[];

/* Further channels that the law reads, then 0: const char *const hydrotwin_law_channels[] = {"p_pump", "force", 0};
   the scenario names each of them in daq.channels. Without it none. */
extern const char *const hydrotwin_law_channels[];

/* Called before the first sample, and after a forgotten memory; returns 0, any other number ends the run as failed. */
int hydrotwin_law_init(const hydrotwin_facts *facts, const double *parameters, double *memory);

/* Called when the plant has centred its valve, and when commands act again. Without it the memory is forgotten then,
   and the law starts as at the first sample. */
void hydrotwin_law_on_safe_state(double *memory);
void hydrotwin_law_on_resume(double *memory);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
