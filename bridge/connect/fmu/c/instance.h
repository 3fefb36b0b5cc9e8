/* An instance of the FMU, whatever the version of FMI: values, phases, steps and saved states. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "model.h"

typedef struct instance instance;
struct instance {
  memory m;
  void (*tell)(instance *self, int status, const char *words); /* log a message */
  void *callbacks;                                             /* of the version of FMI */
  void *environment;
  char *name;
};

/* Returns 0 where the token is another one, or memory is short. */
instance *instance_made(const char *name, const char *token);
void instance_freed(instance *self);
int instance_reset(instance *self);

int instance_initialize(instance *self, double begin);
int instance_run(instance *self);
int instance_end(instance *self);
int instance_step(instance *self, double time, double step);

int instance_set(instance *self, uint32_t reference, int type, number value);
int instance_get(instance *self, uint32_t reference, int type, number *value);

int instance_save(instance *self, void **saved);
int instance_restore(instance *self, const void *saved);
size_t instance_size(void); /* of a state in bytes */
int instance_write(instance *self, const void *saved, void *bytes, size_t size);
int instance_read(instance *self, const void *bytes, size_t size, void **saved);

int instance_fails(instance *self, const char *words);

#endif
