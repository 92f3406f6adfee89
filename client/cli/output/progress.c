#include "client/cli/output/progress.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client/cli/base/clock.h"

#define BAR_CELLS 30
#define INTERVAL_MS 100

static void report(void *context, const char *stage, uint64_t done, uint64_t total)
{
    struct progress *progress = context;
    if (!progress->is_shown || total == 0)
        return;
    int64_t now = clock_now_ms();
    if (progress->is_drawn && now - progress->last_ms < INTERVAL_MS)
        return;
    progress->last_ms = now;
    progress->is_drawn = true;
    double part = done >= total ? 1 : (double)done / (double)total;
    int cells = (int)(part * BAR_CELLS);
    char bar[BAR_CELLS + 1];
    memset(bar, '#', (size_t)cells);
    memset(bar + cells, '.', (size_t)(BAR_CELLS - cells));
    bar[BAR_CELLS] = 0;
    fprintf(stderr, "\r%-10.31s %s%s%s %3d%% of %" PRIu64 "\033[K", stage,
            progress->has_colour ? "\033[36m" : "", bar, progress->has_colour ? "\033[0m" : "",
            (int)(part * 100), total);
    fflush(stderr);
}

struct sheen_progress progress_init(struct progress *progress, bool quiet)
{
    const char *terminal = getenv("TERM");
    const char *no_colour = getenv("NO_COLOR");
    bool can_draw = isatty(STDERR_FILENO) && terminal && strcmp(terminal, "dumb") != 0;
    *progress = (struct progress){
        .is_shown = can_draw && !quiet,
        .is_quiet = quiet,
        .has_colour = !(no_colour && *no_colour),
    };
    return (struct sheen_progress){.report = report, .context = progress};
}

void progress_note(struct progress *progress, const char *format, ...)
{
    if (progress->is_quiet)
        return;
    progress_clear(progress);
    va_list arguments;
    va_start(arguments, format);
    fputs("sheen: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

void progress_clear(struct progress *progress)
{
    if (progress->is_drawn)
        fputs("\r\033[K", stderr);
    progress->is_drawn = false;
}
