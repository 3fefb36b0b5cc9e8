/* What the controller keeps between steps. */
#ifndef CONTROLLER_H
#define CONTROLLER_H

typedef struct {
  double memory[LAW_MEMORY + 1];
  int64_t begun; /* has the law's own init been called? */
} own_state;

#endif
