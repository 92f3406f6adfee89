#include "server/ops/device_choice.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "protocol/number.h"
#include "server/render/gl/device.h"
#include "server/render/native/device.h"

int device_tries(const char *words, struct device_try tries[DEVICE_MOST_TRIES])
{
    const struct device_try native = {&native_renderer_device, NULL};
    uint64_t number;
    bool is_native = strcmp(words, "native") == 0;
    tries[0] = is_native ? native : (struct device_try){&gl_device, words};
    return is_native || strcmp(words, "auto") == 0 || strcmp(words, "software") == 0 ||
           number_parse(words, 0, 1023, false, &number);
}
