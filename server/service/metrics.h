/* The daemon's counters in Prometheus' text format, version 0.0.4. deploy/prometheus/README.md says
 * what each means. Labels have few and fixed values: never a model, a client or a file.
 * Thread: the loop's. */
#ifndef SHEEN_SERVICE_METRICS_H
#define SHEEN_SERVICE_METRICS_H

#include "server/service/session.h"
#include "server/service/report.h"

void metrics_write(const struct session_host *host, struct report *report);

#endif
