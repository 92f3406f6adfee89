#include "server/ops/monitor.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/net/http.h"
#include "server/base/log.h"
#include "server/ops/metrics.h"
#include "server/ops/notify.h"
#include "server/threads/pool.h"

#define TICK_US 1000000u

struct monitor {
    const struct daemon *daemon;
    struct workers *workers;
    const char *trouble;            /* of the workers, as logged last; NULL: none */
    uint64_t stuck_us, watchdog_us; /* watchdog_us is 0 without a watchdog */
    bool was_stuck;
    bool lost_workers; /* a worker program cannot be started any more */
    int timer_fd;
    struct loop_source timer;
    struct listener *listener;
    struct http *http;
};

/* The name of a thread that has worked on one task for too long, or NULL. */
static const char *who_is_stuck(const struct monitor *monitor)
{
    uint64_t now = clock_now_us();
    if (render_thread_busy_us(monitor->daemon->render_thread, now) > monitor->stuck_us)
        return "the GL thread";
    if (render_thread_compiling_us(monitor->daemon->render_thread, now) > monitor->stuck_us)
        return "the compiler of shaders";
    if (pool_busy_us(monitor->daemon->pool, now) > monitor->stuck_us)
        return "a pool thread";
    return pool_busy_us(monitor->daemon->readers, now) > monitor->stuck_us ? "a reader thread"
                                                                           : NULL;
}

/* --- HTTP */

static int get(void *owner, const char *path, struct text_buffer *body)
{
    const struct monitor *monitor = owner;
    const char *stuck = who_is_stuck(monitor);
    if (strcmp(path, "/metrics") == 0) {
        metrics_write(monitor->daemon, body);
        return 200;
    }
    bool ready = strcmp(path, "/readyz") == 0;
    if (!ready && strcmp(path, "/healthz") != 0)
        return 404;
    if (stuck) {
        text_buffer_add(body, "%s has been at one piece of work for more than %llu s\n", stuck,
                        (unsigned long long)(monitor->stuck_us / 1000000));
        return 503;
    }
    const char *trouble = workers_trouble(monitor->workers);
    if (trouble) {
        text_buffer_add(body, "%s\n", trouble);
        return 503;
    }
    if (ready && monitor->daemon->sessions.draining) {
        text_buffer_add(body, "shutting down\n");
        return 503;
    }
    text_buffer_add(body, "ok\n");
    return 200;
}

static void accepted(void *owner, const struct listener *listener, int fd)
{
    (void)listener;
    struct monitor *monitor = owner;
    http_accept(monitor->http, fd);
}

/* --- the clock */

static void feed_watchdog(struct monitor *monitor)
{
    const char *stuck = who_is_stuck(monitor);
    if (!stuck && monitor->watchdog_us)
        notify_send("WATCHDOG=1");
    if (stuck && !monitor->was_stuck)
        log_event(LOG_ERROR, "stuck: the watchdog is not fed any more", log_text("who", stuck),
                  log_number("limit_s", monitor->stuck_us / 1000000));
    else if (!stuck && monitor->was_stuck)
        log_event(LOG_WARN, "not stuck any more",
                  log_number("limit_s", monitor->stuck_us / 1000000));
    monitor->was_stuck = stuck != NULL;
}

bool monitor_has_lost_workers(const struct monitor *monitor)
{
    return monitor->lost_workers;
}

/* Logs when a worker program begins or ceases to be in trouble. The watchdog is fed all the same: frames
 * need no worker. */
static void tell_trouble(struct monitor *monitor)
{
    monitor->lost_workers = workers_are_lost(monitor->workers);
    const char *trouble = workers_trouble(monitor->workers);
    if (trouble == monitor->trouble)
        return;
    monitor->trouble = trouble;
    log_event(trouble ? LOG_ERROR : LOG_WARN, "worker programs",
              log_text("text", trouble ? trouble : "well again"));
}

static void timer_ready(struct loop_source *source, uint32_t events)
{
    (void)events;
    struct monitor *monitor = source->owner;
    uint64_t expirations;
    if (read(monitor->timer_fd, &expirations, sizeof expirations) < 0)
        return;
    feed_watchdog(monitor);
    tell_trouble(monitor);
    if (monitor->http)
        http_tick(monitor->http, clock_now_us());
    if (monitor->listener && listener_is_paused(monitor->listener))
        listener_resume(monitor->listener);
}

/* Starts a timer with half of the watchdog's period, but at most one second. */
static bool start_timer(struct monitor *monitor, struct error *error)
{
    uint64_t us = monitor->watchdog_us ? monitor->watchdog_us / 2 : TICK_US;
    us = us < 1000 ? 1000 : us > TICK_US ? TICK_US : us;
    const struct timespec period = {(time_t)(us / 1000000), (long)(us % 1000000) * 1000};
    const struct itimerspec times = {period, period};
    monitor->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
    if (monitor->timer_fd < 0 || timerfd_settime(monitor->timer_fd, 0, &times, NULL) < 0)
        return error_set(error, ERROR_SERVER, "timerfd: %s", strerror(errno));
    monitor->timer = (struct loop_source){monitor->timer_fd, timer_ready, monitor};
    return loop_watch(monitor->daemon->loop, &monitor->timer, EPOLLIN, error);
}

/* --- its life */

struct monitor *monitor_create(struct daemon *daemon, uint64_t stuck_us, struct error *error)
{
    struct monitor *monitor = calloc(1, sizeof *monitor);
    if (!monitor) {
        error_set(error, ERROR_SERVER, "no memory for the watchdog");
        return NULL;
    }
    monitor->daemon = daemon;
    monitor->workers = &daemon->workers;
    monitor->stuck_us = stuck_us;
    monitor->watchdog_us = notify_watchdog_us();
    monitor->timer_fd = monitor->timer.fd = -1;
    if (!start_timer(monitor, error)) {
        monitor_destroy(monitor);
        return NULL;
    }
    return monitor;
}

void monitor_destroy(struct monitor *monitor)
{
    if (!monitor)
        return;
    listener_close(monitor->listener);
    http_destroy(monitor->http);
    loop_unwatch(monitor->daemon->loop, &monitor->timer);
    if (monitor->timer_fd >= 0)
        close(monitor->timer_fd);
    free(monitor);
}

static bool open_http(struct monitor *monitor, struct error *error)
{
    const struct http_handler handler = {get, monitor};
    if (monitor->listener)
        return error_set(error, ERROR_SERVER, "metrics have one address, not two");
    monitor->http = http_create(monitor->daemon->loop, &handler, error);
    return monitor->http != NULL;
}

bool monitor_listen(struct monitor *monitor, const struct address *address,
                    enum listener_reach reach, struct error *error)
{
    const struct listener_handler handler = {accepted, monitor};
    if (!open_http(monitor, error))
        return false;
    monitor->listener = listener_open(monitor->daemon->loop, address, reach, &handler, error);
    return monitor->listener != NULL;
}

bool monitor_adopt(struct monitor *monitor, int fd, enum listener_reach reach, struct error *error)
{
    const struct listener_handler handler = {accepted, monitor};
    if (!open_http(monitor, error)) {
        close(fd);
        return false;
    }
    monitor->listener = listener_adopt(monitor->daemon->loop, fd, false, reach, &handler, error);
    if (!monitor->listener || listener_kind(monitor->listener) != ADDRESS_TLS)
        return monitor->listener != NULL;
    return error_set(error, ERROR_REQUEST,
                     "the service manager's socket for metrics is beyond the loopback: give it an "
                     "address on loopback, or start sheend with --metrics-open");
}

const char *monitor_address(const struct monitor *monitor)
{
    return monitor->listener ? listener_text(monitor->listener) : "";
}

void monitor_limit(struct monitor *monitor, unsigned most)
{
    if (monitor->http)
        http_limit(monitor->http, most);
}

void monitor_set_stuck(struct monitor *monitor, uint64_t stuck_us)
{
    monitor->stuck_us = stuck_us;
}
