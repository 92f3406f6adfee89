/* The life of the service. */
#include <errno.h>
#include <malloc.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/frame/request.h"
#include "server/ops/notify.h"
#include "server/ops/service_internal.h"

#define TRIM_US 5000000u /* memory unused for so long goes back to the system */
/* for other threads to finish, after the last client has gone while draining */
#define LAST_WORK_TICKS (3000000u / LOOP_TICK_US)
/* To take requests that came before the signal to end: until no input is left, but no longer than both
 * this time and so many batches of events. */
#define LAST_INPUT_US 100000u
#define LAST_INPUT_BATCHES 256u

static void drain(struct service *service);

/* Counts GPU losses that the render thread has reported. The frames that were lost have been
 * answered already. */
static void count_losses(struct service *service)
{
    struct daemon *daemon = &service->daemon;
    while (service->gpu_losses.n < render_thread_losses(daemon->render_thread)) {
        bool often =
            gpu_loss_log_add(&service->gpu_losses, clock_now_us(), daemon->limits.gpu_losses);
        daemon->requests.gpu_generation++;
        log_event(LOG_ERROR, "the GPU was lost",
                  log_number("generation", daemon->requests.gpu_generation));
        if (!often || daemon->sessions.draining)
            continue;
        service->end = SERVICE_START_ANOTHER;
        log_event(LOG_ERROR, "the GPU was lost too often: ending with exit code 75",
                  log_number("gpu_losses", daemon->limits.gpu_losses));
        drain(service);
    }
}

/* Ends a daemon that can read no new file any more. What needs no worker is finished. */
static void end_without_workers(struct service *service)
{
    if (!service->monitor || service->daemon.sessions.draining ||
        !monitor_has_lost_workers(service->monitor))
        return;
    service->end = SERVICE_START_ANOTHER;
    log_event(LOG_ERROR, "a process that starts worker programs has died: ending with exit code 75",
              log_text("program", "sheend-starter"));
    drain(service);
}

/* Exits at once. Other threads may still be working, so nothing can be freed in order. */
static void leave_now(struct service *service)
{
    workers_stop(&service->daemon.workers);
    /* removes its socket file; the other listeners are closed already */
    monitor_destroy(service->monitor);
    if (!service->single)
        log_event(LOG_WARN, "ended while a thread was at work", log_number("code", service->end));
    _exit(service->end);
}

/* Begins to drain when a signal has asked for it and the requests that came before it have been taken. */
static void drain_when_told(struct service *service)
{
    uint64_t told_us = service->told_to_end_us;
    struct loop *loop = service->daemon.loop;
    if (told_us == 0)
        return;
    bool is_over = ++service->batches_since_told >= LAST_INPUT_BATCHES &&
                   clock_now_us() - told_us >= LAST_INPUT_US;
    if (loop_had_input(loop) && !is_over) {
        loop_hurry(loop);
        return;
    }
    service->told_to_end_us = 0;
    drain(service);
}

static void after_batch(void *owner)
{
    struct service *service = owner;
    struct daemon *daemon = &service->daemon;
    count_losses(service);
    drain_when_told(service);
    end_without_workers(service);
    bool draining = daemon->sessions.draining;
    service_settle_sessions(service);
    request_start_next(&daemon->requests);
    bool has_sessions = !LIST_EMPTY(&service->sessions);
    bool any_proxied = service->proxied && !proxied_is_empty(service->proxied);
    loop_set_ticking(daemon->loop, has_sessions || any_proxied || service_rests(service) ||
                                       draining || block_cache_bytes(daemon->block_cache) > 0);
    if (has_sessions || !(service->single || draining))
        return;
    /* No client is left; other threads may still be at work. */
    store_cancel_builds(daemon->store);
    workers_stop(&daemon->workers);
    if (!store_is_building(daemon->store) && scheduler_is_idle(&daemon->requests.scheduler) &&
        daemon->requests.n_file_loads == 0 && daemon->requests.n_computing == 0)
        loop_stop(daemon->loop);
    else if (service->single ||
             daemon->sessions.overdue_ticks > SESSION_LAST_WORDS_TICKS + LAST_WORK_TICKS)
        leave_now(service); /* a tile or a table may still take long, and no client waits for it */
}

static void tick(void *owner)
{
    struct service *service = owner;
    struct daemon *daemon = &service->daemon;
    uint64_t now = clock_now_us();
    session_host_tick(&daemon->sessions, now);
    if (daemon->sessions.overdue_ticks == 1)
        log_event(LOG_WARN, "drain-timeout is over: what is not done is refused",
                  log_number("sessions", daemon->sessions.n_sessions));
    struct session *session;
    LIST_FOREACH (session, &service->sessions, link)
        session_tick(session, now);
    if (now - service->trimmed_us > TRIM_US) {
        service->trimmed_us = now;
        block_cache_trim(daemon->block_cache);
        malloc_trim(0); /* pages within the heap that are free */
    }
    if (service->proxied)
        proxied_tick(service->proxied, now, daemon->sessions.limits.handshake_s * 1000000);
    service_resume_listeners(service);
}

/* --- the end */

static void drain(struct service *service)
{
    struct session_host *sessions = &service->daemon.sessions;
    if (sessions->draining)
        leave_now(service); /* a second signal */
    sessions->draining = true;
    sessions->drain_start_us = clock_now_us();
    service_close_listeners(service);
    if (!service->single) /* $NOTIFY_SOCKET of a private daemon belongs to its client */
        notify_send("STOPPING=1\nSTATUS=finishing what is in flight");
    log_event(LOG_INFO, "shutting down", log_number("sessions", sessions->n_sessions));
}

/* Puts into force the options that may change while the daemon serves. Takes `access` over. */
static void apply(struct service *service, const struct service_options *options,
                  struct access *access)
{
    struct daemon *daemon = &service->daemon;
    access_destroy(daemon->access);
    daemon->access = daemon->sessions.access = access;
    service->options = *options;
    for (size_t i = 0; i < service->n_listeners; i++)
        listener_open_to_all(service->listeners[i], access_has_list(access));
    struct session *session;
    LIST_FOREACH (session, &service->sessions, link)
        session_check_access(session, true);
    daemon->limits = options->limits;
    daemon->sessions.limits = options->limits.session;
    workers_set_times(&daemon->workers, &options->limits.workers);
    /* The client of a private daemon shows the last line of its log when the daemon dies. */
    log_set(service->single ? LOG_ERROR : options->log_level, options->log_format);
    if (service->monitor)
        monitor_set_stuck(service->monitor, options->stuck_s * 1000000);
}

/* The new rules of access, or NULL with *error if the open listeners cannot work with them. */
static struct access *access_for(const struct service *service,
                                 const struct service_options *options, struct error *error)
{
    struct access *access = access_create(&options->access, error);
    if (access && service_has_tls(service) && !access_can_tls(access, error)) {
        access_destroy(access);
        return NULL;
    }
    return access;
}

static void reload(struct service *service)
{
    struct error error = {0};
    struct service_options options;
    struct access *access = NULL;
    notify_send("RELOADING=1");
    if (service->reloader.read(service->reloader.owner, &options, &error))
        access = access_for(service, &options, &error);
    if (access) {
        apply(service, &options, access);
        log_event(LOG_INFO, "configuration reloaded", log_text("version", SHEEN_VERSION));
    } else {
        log_event(LOG_ERROR, "the new configuration is bad: the old one stays",
                  log_text("text", error.text));
    }
    notify_send("READY=1");
}

static void signal_ready(struct loop_source *source, uint32_t events)
{
    (void)events;
    struct service *service = source->owner;
    struct signalfd_siginfo signal;
    if (read(service->signal_fd, &signal, sizeof signal) != (ssize_t)sizeof signal)
        return;
    if (signal.ssi_signo != SIGHUP)
        service->told_to_end_us = clock_now_us();
    else if (service->reloader.read && !service->daemon.sessions.draining)
        reload(service);
}

static bool watch_signals(struct service *service, struct error *error)
{
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    if (!service->single)
        sigaddset(&set, SIGHUP); /* a private daemon ends with its terminal */
    signal(SIGPIPE, SIG_IGN);    /* the reader of the log may have closed the pipe */
    /* Before any thread starts: threads inherit the mask. */
    pthread_sigmask(SIG_BLOCK, &set, NULL);
    service->signal_fd = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    if (service->signal_fd < 0)
        return error_set(error, ERROR_SERVER, "signalfd: %s", strerror(errno));
    service->signals = (struct loop_source){service->signal_fd, signal_ready, service};
    return loop_watch(service->daemon.loop, &service->signals, EPOLLIN, error);
}

bool service_make_loop(struct service *service, struct error *error)
{
    const struct loop_hooks hooks = {after_batch, tick, service};
    return (service->daemon.loop = loop_create(&hooks, error)) && watch_signals(service, error);
}

/* --- start and stop */

static void tell_ready(const struct service *service)
{
    char addresses[SERVICE_MAX_LISTENERS * LISTENER_TEXT_BYTES];
    const char *device = render_thread_info(service->daemon.render_thread)->device;
    service_list_addresses(service, addresses, sizeof addresses);
    log_event(LOG_INFO, "listening", log_text("version", SHEEN_VERSION), log_text("device", device),
              log_text("addresses", addresses),
              log_text("metrics", monitor_address(service->monitor)));
    notify_send("READY=1\nSTATUS=serving");
}

struct service *service_create(const struct service_options *options,
                               const struct service_reloader *reloader, struct error *error)
{
    struct service *service = calloc(1, sizeof *service);
    if (!service) {
        error_set(error, ERROR_SERVER, "no memory for the daemon");
        return NULL;
    }
    service->signal_fd = service->daemon.requests.models_fd = -1;
    LIST_INIT(&service->sessions);
    service->reloader = *reloader;
    service->single = options->session_fd >= 0;
    struct access *access = access_create(&options->access, error);
    if (access)
        apply(service, options, access);
    if (!access || !service_start(service, error)) {
        service_destroy(service);
        return NULL;
    }
    if (service->single)
        service->daemon.sessions.limits.idle_s = 0;
    else
        tell_ready(service);
    return service;
}

enum service_end service_run(struct service *service)
{
    loop_run(service->daemon.loop);
    return service->end;
}

/* The order matters: the store frees its models on the render thread, so it goes first. What the
 * pools and the render thread finish while they stop is still delivered before the completions
 * go. */
void service_destroy(struct service *service)
{
    if (!service)
        return;
    struct daemon *daemon = &service->daemon;
    service_close_listeners(service);
    monitor_destroy(service->monitor);
    while (!LIST_EMPTY(&service->sessions)) {
        struct session *session = LIST_FIRST(&service->sessions);
        LIST_REMOVE(session, link);
        session_destroy(session);
    }
    store_destroy(daemon->store);
    render_thread_destroy(daemon->render_thread);
    pool_destroy(daemon->pool);
    pool_destroy(daemon->readers);
    workers_finish(&daemon->workers);
    if (daemon->completions)
        completions_deliver(daemon->completions);
    completions_destroy(daemon->completions);
    if (service->signal_fd >= 0)
        close(service->signal_fd);
    loop_destroy(daemon->loop);
    access_destroy(daemon->access);
    block_cache_destroy(daemon->block_cache);
    if (daemon->requests.models_fd >= 0)
        close(daemon->requests.models_fd);
    free(service);
}
