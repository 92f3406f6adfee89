/* Translates the value of `--device` into the devices to open. Pure; any thread. */
#ifndef SHEEN_OPS_DEVICE_CHOICE_H
#define SHEEN_OPS_DEVICE_CHOICE_H

#include <stdbool.h>

struct renderer_device;

enum { DEVICE_MOST_TRIES = 2 };

/* A device to open: its kind, and which one of that kind (renderer_options.device). */
struct device_try {
    const struct renderer_device *kind;
    const char *device;
    bool has_driver; /* it draws by code that is not sheend's own (sandbox/confine.h) */
};

/* Fills in the devices that `words` asks for, in the order in which they are to be tried until one
 * opens, and returns their number. `words` is "auto" (a GPU, else processors), "software" or
 * "native" (processors), or the number of an EGL device. Returns 0 for any other text. A try may
 * point to `words`, which must stay valid as long as the tries. */
int device_tries(const char *words, struct device_try tries[DEVICE_MOST_TRIES]);

#endif
