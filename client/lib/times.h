/* Converts the times of a message to those of sheen.h. Pure, any thread. */
#ifndef SHEEN_CLIENT_TIMES_H
#define SHEEN_CLIENT_TIMES_H

#include "client/lib/sheen.h"
#include "sheen.pb.h"

static inline struct sheen_times times_from_message(const sheen_Times *times)
{
    return (struct sheen_times){
        .tables_us = times->tables_us,
        .visibility_us = times->visibility_us,
        .evaluate_us = times->evaluate_us,
        .shade_us = times->shade_us,
        .readback_us = times->readback_us,
        .encode_us = times->encode_us,
        .total_us = times->total_us,
    };
}

#endif
