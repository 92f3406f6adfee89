#include "server/ops/device_choice.h"

#include <stdint.h>
#include <string.h>

#include "protocol/number.h"
#include "server/render/gl/device.h"
#include "server/render/native/device.h"

int device_tries(const char *words, struct device_try tries[DEVICE_MOST_TRIES])
{
    const struct device_try hardware = {&gl_device, "hardware", true},
                            native = {&native_renderer_device, NULL, false};
    uint64_t number;
    if (number_parse(words, 0, 1023, false, &number)) {
        tries[0] = (struct device_try){&gl_device, words, true};
        return 1;
    }
    if (strcmp(words, "auto") == 0) {
        tries[0] = hardware;
        tries[1] = native;
        return 2;
    }
    tries[0] = native;
    return strcmp(words, "software") == 0 || strcmp(words, "native") == 0;
}
