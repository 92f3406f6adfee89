#include "tests/bench/timing.h"

void note_device(report *report, const struct renderer_info &info)
{
    report->note("device", std::string(info.device) + ", " + info.driver);
    report->note("times of stages and frames",
                 info.timed_by_device
                     ? "the device's own, by GL timer queries; wall and all are by the clock"
                     : "by the clock, waiting after each stage: GL timestamps of a software device "
                       "leave its vertex stage out");
}
