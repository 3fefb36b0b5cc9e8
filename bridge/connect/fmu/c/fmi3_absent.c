/* Functions of FMI 3.0 that an FMU must have and this one never needs: modes, clocks, derivatives. */
#include "fmi/fmi3Functions.h"
#include "instance.h"

#define ABSENT(NAME, ...) \
  fmi3Status NAME(fmi3Instance c, __VA_ARGS__) { return (fmi3Status)instance_fails(c, #NAME " is not supported"); }
#define ABSENT_PLAIN(NAME) \
  fmi3Status NAME(fmi3Instance c) { return (fmi3Status)instance_fails(c, #NAME " is not supported"); }

typedef const fmi3ValueReference *references;

ABSENT_PLAIN(fmi3EnterEventMode)
ABSENT_PLAIN(fmi3EnterConfigurationMode)
ABSENT_PLAIN(fmi3ExitConfigurationMode)
ABSENT_PLAIN(fmi3EvaluateDiscreteStates)
ABSENT_PLAIN(fmi3EnterContinuousTimeMode)
ABSENT_PLAIN(fmi3EnterStepMode)
ABSENT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference at, size_t *n)
ABSENT(fmi3GetVariableDependencies, fmi3ValueReference at, size_t *elements, fmi3ValueReference *independents,
       size_t *of, fmi3DependencyKind *kinds, size_t n)
ABSENT(fmi3GetDirectionalDerivative, references unknown, size_t n, references known, size_t m, const fmi3Float64 *seed,
       size_t seeds, fmi3Float64 *sensitivity, size_t sensitivities)
ABSENT(fmi3GetAdjointDerivative, references unknown, size_t n, references known, size_t m, const fmi3Float64 *seed,
       size_t seeds, fmi3Float64 *sensitivity, size_t sensitivities)
ABSENT(fmi3GetIntervalDecimal, references at, size_t n, fmi3Float64 *intervals, fmi3IntervalQualifier *qualifiers)
ABSENT(fmi3GetIntervalFraction, references at, size_t n, fmi3UInt64 *counters, fmi3UInt64 *resolutions,
       fmi3IntervalQualifier *qualifiers)
ABSENT(fmi3GetShiftDecimal, references at, size_t n, fmi3Float64 *shifts)
ABSENT(fmi3GetShiftFraction, references at, size_t n, fmi3UInt64 *counters, fmi3UInt64 *resolutions)
ABSENT(fmi3SetIntervalDecimal, references at, size_t n, const fmi3Float64 *intervals)
ABSENT(fmi3SetIntervalFraction, references at, size_t n, const fmi3UInt64 *counters, const fmi3UInt64 *resolutions)
ABSENT(fmi3SetShiftDecimal, references at, size_t n, const fmi3Float64 *shifts)
ABSENT(fmi3SetShiftFraction, references at, size_t n, const fmi3UInt64 *counters, const fmi3UInt64 *resolutions)
ABSENT(fmi3UpdateDiscreteStates, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals, fmi3Boolean *values,
       fmi3Boolean *has_next, fmi3Float64 *next)
ABSENT(fmi3CompletedIntegratorStep, fmi3Boolean never_back, fmi3Boolean *event, fmi3Boolean *terminate)
ABSENT(fmi3SetTime, fmi3Float64 time)
ABSENT(fmi3SetContinuousStates, const fmi3Float64 *states, size_t n)
ABSENT(fmi3GetContinuousStateDerivatives, fmi3Float64 *derivatives, size_t n)
ABSENT(fmi3GetEventIndicators, fmi3Float64 *indicators, size_t n)
ABSENT(fmi3GetContinuousStates, fmi3Float64 *states, size_t n)
ABSENT(fmi3GetNominalsOfContinuousStates, fmi3Float64 *nominals, size_t n)
ABSENT(fmi3GetNumberOfEventIndicators, size_t *n)
ABSENT(fmi3GetNumberOfContinuousStates, size_t *n)
ABSENT(fmi3GetOutputDerivatives, references at, size_t n, const fmi3Int32 *orders, fmi3Float64 *values, size_t m)
ABSENT(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
