/* Which devices `--device` means. Pure; any thread. */
#ifndef SHEEN_OPS_DEVICE_CHOICE_H
#define SHEEN_OPS_DEVICE_CHOICE_H

struct renderer_device;

enum { DEVICE_MOST_TRIES = 2 };

/* A device to open: its kind, and which one of that kind (renderer_options.device). */
struct device_try {
    const struct renderer_device *kind;
    const char *device;
};

/* Fills in the devices that `words` asks for, to be opened in this order until one opens, and
 * returns how many: "auto", "software", "native", or the number of an EGL device. 0 for other words.
 * `words` must live as long as the tries. */
int device_tries(const char *words, struct device_try tries[DEVICE_MOST_TRIES]);

#endif
