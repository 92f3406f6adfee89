#include "server/service/service.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/service/listen.h"
#include "server/service/request.h"
#include "server/service/session.h"

#define SERVICE_OWN_DESCRIPTORS 128u /* listeners, devices, libraries: more than are used */

struct service {
    struct session_host host;
    struct completions *completions;
    struct listener *listeners[SERVICE_MAX_LISTENERS];
    size_t n_listeners;
    struct loop_source signals;
    int signal_fd;
    struct session *sessions;
    bool single; /* ends with its session */
};

/* --- sessions */

/* One message and the end, for a client that cannot have a session. It has no buffers: what the
 * socket does not take at once is lost. */
static void turn_away(int fd, const char *text)
{
    sheen_Error error = {.code = sheen_ErrorCode_ERROR_OVERLOADED};
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length;
    snprintf(error.text, sizeof error.text, "%s", text);
    if (message_encode(MESSAGE_ERROR, 0, &error, buffer, sizeof buffer, &length) &&
        send(fd, buffer, length, MSG_NOSIGNAL | MSG_DONTWAIT) > 0)
        shutdown(fd, SHUT_WR);
    close(fd);
}

static void accepted(void *owner, int fd)
{
    struct service *service = owner;
    struct session_host *host = &service->host;
    struct error error = {0};
    if (service->host.n_sessions >= service->host.limits.max_connections) {
        service->host.stats.errors++;
        turn_away(fd, "the daemon has as many clients as it takes: try again later");
        return;
    }
    struct peer *peer = peer_get(&host->memory.peers, fd);
    if (!peer || peer->n_connections >= host->limits.max_peer_connections) {
        host->stats.errors++;
        turn_away(fd, peer ? "this user or address has as many connections as it may: close one"
                           : "no memory for another client: try again later");
        peer_put(&host->memory.peers, peer);
        return;
    }
    struct session *session = session_create(host, fd, peer, &error);
    if (!session) {
        fprintf(stderr, "sheend: a client was turned away: %s\n", error.text);
        return;
    }
    session->next = service->sessions;
    service->sessions = session;
}

static void settle_sessions(struct service *service)
{
    for (struct session **link = &service->sessions; *link;) {
        struct session *session = *link;
        if (session_settle(session)) {
            link = &session->next;
            continue;
        }
        *link = session->next;
        session_destroy(session);
    }
}

static bool any_paused(const struct service *service)
{
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_is_paused(service->listeners[i]))
            return true;
    return false;
}

static void after_batch(void *owner)
{
    struct service *service = owner;
    settle_sessions(service);
    request_start_next(&service->host);
    loop_set_ticking(service->host.loop, service->sessions || any_paused(service));
    if (service->sessions || !(service->single || service->host.draining))
        return;
    /* Nobody is left to answer; other threads may still be at work. */
    store_cancel_builds(service->host.store);
    workers_stop(&service->host.workers);
    if (!store_is_building(service->host.store) && scheduler_is_idle(&service->host.scheduler))
        loop_stop(service->host.loop);
    else if (service->single)
        _exit(0); /* a tile or a table may take long yet: nobody wants them */
}

static void tick(void *owner)
{
    struct service *service = owner;
    uint64_t now = loop_now_us();
    for (struct session *session = service->sessions; session; session = session->next)
        session_tick(session, now);
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_is_paused(service->listeners[i]))
            listener_resume(service->listeners[i]);
}

/* --- the end */

static void close_listeners(struct service *service)
{
    while (service->n_listeners > 0)
        listener_close(service->listeners[--service->n_listeners]);
}

static void signal_ready(struct loop_source *source, uint32_t events)
{
    (void)events;
    struct service *service = source->owner;
    struct signalfd_siginfo signal;
    if (read(service->signal_fd, &signal, sizeof signal) != (ssize_t)sizeof signal)
        return;
    if (service->host.draining) {
        workers_stop(&service->host.workers);
        _exit(0); /* asked twice: at once, with the listeners gone already */
    }
    service->host.draining = true;
    service->host.drain_start_us = loop_now_us();
    close_listeners(service);
}

static bool watch_signals(struct service *service, struct error *error)
{
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGINT);
    /* Before any thread starts: threads inherit the mask. */
    pthread_sigmask(SIG_BLOCK, &set, NULL);
    service->signal_fd = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
    if (service->signal_fd < 0)
        return error_set(error, ERROR_SERVER, "signalfd: %s", strerror(errno));
    service->signals = (struct loop_source){service->signal_fd, signal_ready, service};
    return loop_watch(service->host.loop, &service->signals, EPOLLIN, error);
}

/* --- start and stop */

static bool open_listeners(struct service *service, const struct service_options *options,
                           struct error *error)
{
    for (size_t i = 0; i < options->n_listen; i++) {
        struct listener *listener =
            listener_open(service->host.loop, &options->listen[i], accepted, service, error);
        if (!listener)
            return false;
        service->listeners[service->n_listeners++] = listener;
    }
    return true;
}

static bool open_session(struct service *service, int fd, struct error *error)
{
    service->single = true;
    struct peer *peer = peer_get(&service->host.memory.peers, fd);
    struct session *session = peer ? session_create(&service->host, fd, peer, error) : NULL;
    service->sessions = session;
    return session || (peer ? false : error_set(error, ERROR_SERVER, "no memory for a client"));
}

/* A descriptor for every client, as far as the system lets us. */
static void allow_descriptors(uint64_t n)
{
    struct rlimit files;
    if (getrlimit(RLIMIT_NOFILE, &files) < 0 || files.rlim_cur >= n)
        return;
    files.rlim_cur = files.rlim_max < n ? files.rlim_max : n;
    setrlimit(RLIMIT_NOFILE, &files); /* with fewer, accepting rests when they are used up */
}

static bool start(struct service *service, const struct service_options *options,
                  struct error *error)
{
    struct session_host *host = &service->host;
    const struct loop_hooks hooks = {after_batch, tick, service};
    const struct renderer_options renderer = {.device = options->device};
    /* The reader of cages starts while the device opens. */
    if (!(host->loop = loop_create(&hooks, error)) || !watch_signals(service, error) ||
        !workers_init(&host->workers, NULL, options->limits.memory_budget, error) ||
        !(service->completions = completions_create(host->loop, error)) ||
        !(host->render_thread = render_thread_create(&renderer, service->completions, error)) ||
        !(host->pool = pool_create("sheend-pool", options->n_threads, 1, &encode_worker,
                                   service->completions, error)) ||
        !(host->readers = pool_create("sheend-read", STORE_MAX_BUILDS, 0, &(struct pool_worker){0},
                                      service->completions, error)) ||
        !(host->store = store_create(host->pool, host->readers, host->render_thread, &host->workers,
                                     options->limits.memory_budget,
                                     (uint32_t)options->limits.max_image_side, error)))
        return false;
    const struct limits *limits = &options->limits;
    host->limits = *limits;
    host->max_upload_bytes =
        limits->memory_budget < limits->max_upload ? limits->memory_budget : limits->max_upload;
    host->memory = (struct memory){.store = host->store, .limits = &host->limits};
    allow_descriptors(limits->max_connections + SERVICE_OWN_DESCRIPTORS);
    stats_init(&host->stats);
    if (options->session_fd >= 0)
        return open_session(service, options->session_fd, error);
    workers_expect_images(&host->workers);
    return open_listeners(service, options, error);
}

struct service *service_create(const struct service_options *options, struct error *error)
{
    struct service *service = calloc(1, sizeof *service);
    if (!service) {
        error_set(error, ERROR_SERVER, "no memory for the daemon");
        return NULL;
    }
    service->signal_fd = -1;
    if (!start(service, options, error)) {
        service_destroy(service);
        return NULL;
    }
    return service;
}

void service_run(struct service *service)
{
    loop_run(service->host.loop);
}

/* The store frees its models through the GL thread, so that ends last; what both threads finish is
 * delivered in between. */
void service_destroy(struct service *service)
{
    if (!service)
        return;
    struct session_host *host = &service->host;
    close_listeners(service);
    while (service->sessions) {
        struct session *session = service->sessions;
        service->sessions = session->next;
        session_destroy(session);
    }
    store_destroy(host->store);
    render_thread_destroy(host->render_thread);
    pool_destroy(host->pool);
    pool_destroy(host->readers);
    workers_finish(&host->workers);
    if (service->completions)
        completions_deliver(service->completions);
    completions_destroy(service->completions);
    if (service->signal_fd >= 0)
        close(service->signal_fd);
    loop_destroy(host->loop);
    free(service);
}

const struct renderer_info *service_device(const struct service *service)
{
    return render_thread_info(service->host.render_thread);
}

void service_addresses(const struct service *service, char *text, size_t capacity)
{
    size_t used = 0;
    text[0] = 0;
    for (size_t i = 0; i < service->n_listeners && used < capacity; i++)
        used += (size_t)snprintf(text + used, capacity - used, "%s%s", i ? ", " : "",
                                 listener_text(service->listeners[i]));
}
