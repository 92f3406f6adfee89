/* Writes the daemon's counters in Prometheus' text format, version 0.0.4.
 * deploy/prometheus/README.md says what each metric means. Labels have few and fixed values: never
 * a model, a client or a file.
 * Thread: the loop's. */
#ifndef SHEEN_OPS_METRICS_H
#define SHEEN_OPS_METRICS_H

#include "server/ops/daemon.h"
#include "server/base/text_buffer.h"

void metrics_write(const struct daemon *daemon, struct text_buffer *text);

#endif
