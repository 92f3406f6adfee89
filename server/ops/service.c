#include "server/ops/service.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/output/jpeg.h"
#include "server/net/listen.h"
#include "server/net/proxied.h"
#include "server/ops/gpu_loss_log.h"
#include "server/assets/model_file.h"
#include "server/ops/daemon.h"
#include "server/ops/device_choice.h"
#include "server/ops/monitor.h"
#include "server/ops/notify.h"
#include "server/threads/pool.h"
#include "server/frame/request.h"
#include "server/session/session.h"

#define SERVICE_TRIM_US 5000000u /* memory unused for so long goes back to the system */
/* for other threads to finish, after the last client has gone while draining */
#define SERVICE_LAST_WORK_US 3000000u
#define SERVICE_LAST_INPUT_US 100000u /* to take requests that came before the signal to end */
#define SERVICE_OWN_DESCRIPTORS 128u  /* for listeners, devices and libraries; more than are used */

struct service {
    struct service_options options; /* the options in force */
    struct service_reloader reloader;
    struct daemon daemon;
    struct monitor *monitor; /* NULL with a single session */
    struct listener *listeners[SERVICE_MAX_LISTENERS];
    size_t n_listeners;
    struct proxied *proxied; /* NULL with a single session, and while draining */
    struct loop_source signals;
    int signal_fd;
    LIST_HEAD(session_list, session) sessions;
    struct gpu_loss_log gpu_losses;
    uint64_t trimmed_us; /* when the block cache was last trimmed */
    enum service_end end;
    uint64_t told_to_end_us; /* when a signal came; 0: none came, or drain() has been called */
    bool overdue;            /* drain-timeout has passed and is logged */
    bool single;             /* private daemon: ends with its session */
};

/* --- sessions */

/* Closes the connection of a client that gets no session, after an error message with `text` unless
 * it is NULL. */
static void turn_away(int fd, const char *text)
{
    sheen_Error error = {.code = sheen_ErrorCode_ERROR_OVERLOADED};
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length = 0;
    snprintf(error.text, sizeof error.text, "%s", text ? text : "");
    if (text && !message_encode(MESSAGE_ERROR, 0, &error, buffer, sizeof buffer, &length))
        length = 0;
    conn_turn_away(fd, buffer, length);
}

/* False with *error when there are as many clients as allowed. */
static bool has_room(const struct daemon *daemon, struct error *error)
{
    return daemon->sessions.n_sessions < daemon->limits.max_connections ||
           error_set(error, ERROR_SERVER,
                     "the daemon has as many clients as it takes: try again later");
}

static void log_turned_away(struct service *service, enum log_level level, const char *peer,
                            const struct listener *listener, const char *text)
{
    service->daemon.sessions.stats.refused++;
    log_event(level, "client turned away", log_text("peer", peer),
              log_text("listener", listener_text(listener)), log_text("text", text));
}

/* Starts a session for a new connection. A TLS client is not identified before its HELLO. */
static void welcome(struct service *service, const struct listener *listener, int fd,
                    const struct session_client *client)
{
    struct daemon *daemon = &service->daemon;
    struct session *session = NULL;
    struct session_seat seat = {0};
    struct error error = {0};
    bool stranger = client->kind == CLIENT_TLS;
    if (has_room(daemon, &error) &&
        (stranger || session_take_seat(&daemon->sessions, &client->identity, &seat, &error))) {
        session = session_create(&daemon->sessions, fd, client, seat, &error);
    } else {
        daemon->sessions.stats.errors++;
        turn_away(fd, stranger ? NULL : error.text); /* a stranger is told nothing */
    }
    if (session)
        LIST_INSERT_HEAD(&service->sessions, session, link);
    else
        log_turned_away(service, LOG_WARN, client->peer, listener, error.text);
}

/* Handles a new connection from address `from`, which the socket shows, or a balancer's PROXY
 * header (by_balancer). */
static void came_from(struct service *service, const struct listener *listener, int fd,
                      const struct sockaddr *from, bool by_balancer)
{
    struct daemon *daemon = &service->daemon;
    struct error error = {0};
    const enum address_kind kind = listener_kind(listener);
    struct session_client client = {.kind = kind == ADDRESS_UNIX  ? CLIENT_UNIX
                                            : kind == ADDRESS_TCP ? CLIENT_TCP
                                                                  : CLIENT_TLS};
    if (kind == ADDRESS_UNIX)
        peer_describe(fd, client.peer);
    else
        peer_describe_address(from, client.peer);
    client.from = peer_of_address(from);
    client.is_balancer = !by_balancer && proxy_networks_hold(&service->options.proxy_from, from);
    if (kind == ADDRESS_TLS) {
        if (client.is_balancer ||
            strangers_admits(&daemon->sessions.strangers, &client.from, clock_now_us())) {
            welcome(service, listener, fd, &client);
            return;
        }
        conn_turn_away(fd, NULL, 0);
        log_turned_away(service, LOG_DEBUG, client.peer, listener,
                        "its address has come without credentials again and again");
    } else if (access_admit_local(daemon->access, fd, kind, &client.identity, &error)) {
        if (by_balancer)
            access_admit_proxied(&client.from, &client.identity);
        welcome(service, listener, fd, &client);
    } else {
        conn_turn_away(fd, NULL, 0); /* a stranger is told nothing */
        log_turned_away(service, LOG_WARN, client.peer, listener, error.text);
    }
}

static void accepted(void *owner, const struct listener *listener, int fd)
{
    struct service *service = owner;
    struct sockaddr_storage address;
    const struct sockaddr *from = (const struct sockaddr *)&address;
    peer_address(fd, &address); /* if the peer has gone already, the address is unknown */
    if (proxy_networks_hold(&service->options.proxy_from, from))
        proxied_accept(service->proxied, listener, fd);
    else
        came_from(service, listener, fd, from, false);
}

static void header_arrived(void *owner, const struct listener *listener, int fd,
                           const struct sockaddr *from)
{
    struct sockaddr_storage address;
    peer_address(fd, &address);
    came_from(owner, listener, fd, from ? from : (const struct sockaddr *)&address, from != NULL);
}

static void header_refused(void *owner, const struct listener *listener, const char *why)
{
    log_turned_away(owner, LOG_WARN, "a balancer of --proxy-from", listener, why);
}

static void settle_sessions(struct service *service)
{
    struct session *session = LIST_FIRST(&service->sessions);
    while (session) {
        struct session *next = LIST_NEXT(session, link);
        if (!session_settle(session)) {
            LIST_REMOVE(session, link);
            session_destroy(session);
        }
        session = next;
    }
}

static bool any_paused(const struct service *service)
{
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_is_paused(service->listeners[i]))
            return true;
    return false;
}

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
        service->end = SERVICE_GPU_LOST;
        log_event(LOG_ERROR, "the GPU was lost too often: ending with exit code 75",
                  log_number("gpu_losses", daemon->limits.gpu_losses));
        drain(service);
    }
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
    if (told_us == 0 || (!intake_is_empty(loop_intake(service->daemon.loop)) &&
                         clock_now_us() - told_us < SERVICE_LAST_INPUT_US))
        return;
    service->told_to_end_us = 0;
    drain(service);
}

static void after_batch(void *owner)
{
    struct service *service = owner;
    struct daemon *daemon = &service->daemon;
    count_losses(service);
    drain_when_told(service);
    bool draining = daemon->sessions.draining;
    settle_sessions(service);
    request_start_next(&daemon->requests);
    bool has_sessions = !LIST_EMPTY(&service->sessions);
    bool any_proxied = service->proxied && !proxied_is_empty(service->proxied);
    loop_set_ticking(daemon->loop, has_sessions || any_proxied || any_paused(service) || draining ||
                                       block_cache_bytes(daemon->block_cache) > 0);
    if (has_sessions || !(service->single || draining))
        return;
    /* No client is left; other threads may still be at work. */
    store_cancel_builds(daemon->store);
    workers_stop(&daemon->workers);
    if (!store_is_building(daemon->store) && scheduler_is_idle(&daemon->requests.scheduler) &&
        daemon->requests.n_file_loads == 0)
        loop_stop(daemon->loop);
    else if (service->single || session_host_overdue_us(&daemon->sessions, clock_now_us()) >
                                    SESSION_LAST_WORDS_US + SERVICE_LAST_WORK_US)
        leave_now(service); /* a tile or a table may still take long, and no client waits for it */
}

static void tick(void *owner)
{
    struct service *service = owner;
    struct daemon *daemon = &service->daemon;
    uint64_t now = clock_now_us();
    if (!service->overdue && session_host_overdue_us(&daemon->sessions, now) > 0) {
        service->overdue = true;
        log_event(LOG_WARN, "drain-timeout is over: what is not done is refused",
                  log_number("sessions", daemon->sessions.n_sessions));
    }
    struct session *session;
    LIST_FOREACH (session, &service->sessions, link)
        session_tick(session, now);
    if (now - service->trimmed_us > SERVICE_TRIM_US) {
        service->trimmed_us = now;
        block_cache_trim(daemon->block_cache);
    }
    if (service->proxied)
        proxied_tick(service->proxied, now, daemon->sessions.limits.handshake_s * 1000000);
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_is_paused(service->listeners[i]))
            listener_resume(service->listeners[i]);
}

/* --- the end */

static void close_listeners(struct service *service)
{
    proxied_destroy(service->proxied);
    service->proxied = NULL;
    while (service->n_listeners > 0)
        listener_close(service->listeners[--service->n_listeners]);
}

static void drain(struct service *service)
{
    struct session_host *sessions = &service->daemon.sessions;
    if (sessions->draining)
        leave_now(service); /* a second signal */
    sessions->draining = true;
    sessions->drain_start_us = clock_now_us();
    close_listeners(service);
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

static bool has_tls_listener(const struct service *service)
{
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_kind(service->listeners[i]) == ADDRESS_TLS)
            return true;
    return false;
}

/* The new rules of access, or NULL with *error if the open listeners cannot work with them. */
static struct access *access_for(const struct service *service,
                                 const struct service_options *options, struct error *error)
{
    struct access *access = access_create(&options->access, error);
    if (access && has_tls_listener(service) && !access_can_tls(access, error)) {
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

/* --- start and stop */

/* Keeps an opened listener. `listener` may be NULL: then *error is already set, and false is
 * returned. */
static bool keep_listener(struct service *service, struct listener *listener, struct error *error)
{
    if (!listener)
        return false;
    service->listeners[service->n_listeners++] = listener;
    listener_open_to_all(listener, access_has_list(service->daemon.access));
    return listener_kind(listener) != ADDRESS_TLS || access_can_tls(service->daemon.access, error);
}

/* Takes over the service manager's sockets. One named "metrics" serves metrics, one named "tls"
 * speaks TLS. */
static bool adopt_listeners(struct service *service, struct error *error)
{
    struct notify_fds fds;
    const struct listener_handler handler = {accepted, service};
    if (!notify_listen_fds(&fds, error))
        return false;
    bool ok = true;
    for (size_t i = 0; i < fds.n; i++) {
        if (!ok)
            close(fds.fd[i]);
        else if (strcmp(fds.name[i], "metrics") == 0)
            ok = monitor_adopt(service->monitor, fds.fd[i],
                               service_metrics_reach(&service->options), error);
        else if (service->n_listeners < SERVICE_MAX_LISTENERS)
            ok = keep_listener(service,
                               listener_adopt(service->daemon.loop, fds.fd[i],
                                              strcmp(fds.name[i], "tls") == 0, LISTENER_LOOPBACK,
                                              &handler, error),
                               error);
        else
            ok = error_set(error, ERROR_SERVER, "more than %d sockets from the service manager",
                           SERVICE_MAX_LISTENERS);
    }
    return ok;
}

static bool open_listeners(struct service *service, struct error *error)
{
    const struct listener_handler handler = {accepted, service};
    struct service_listen listen = service->options.listen;
    const struct proxied_handler proxied = {header_arrived, header_refused, service};
    if (!(service->proxied = proxied_create(service->daemon.loop, &proxied)))
        return error_set(error, ERROR_SERVER, "no memory for the daemon");
    if (!adopt_listeners(service, error))
        return false;
    if (listen.n == 0 && service->n_listeners == 0) {
        listen.n = 1;
        if (!listener_default(&listen.address[0], error))
            return false;
    }
    for (size_t i = 0; i < listen.n; i++) {
        if (service->n_listeners == SERVICE_MAX_LISTENERS)
            return error_set(error, ERROR_SERVER, "at most %d addresses to listen on",
                             SERVICE_MAX_LISTENERS);
        if (!keep_listener(service,
                           listener_open(service->daemon.loop, &listen.address[i],
                                         LISTENER_LOOPBACK, &handler, error),
                           error))
            return false;
    }
    const struct service_listen *metrics = &service->options.metrics;
    return metrics->n == 0 || monitor_listen(service->monitor, &metrics->address[0],
                                             service_metrics_reach(&service->options), error);
}

static bool open_session(struct service *service, int fd, struct error *error)
{
    struct daemon *daemon = &service->daemon;
    struct session_client client = {.kind = CLIENT_PRIVATE, .peer = "private"};
    access_admit_private(&client.identity);
    struct session_seat seat;
    if (!session_take_seat(&daemon->sessions, &client.identity, &seat, error))
        return false;
    struct session *session = session_create(&daemon->sessions, fd, &client, seat, error);
    if (session)
        LIST_INSERT_HEAD(&service->sessions, session, link);
    return session != NULL;
}

/* Raises the limit of descriptors to `n`, or as far as the system allows. */
static void allow_descriptors(uint64_t n)
{
    struct rlimit files;
    if (getrlimit(RLIMIT_NOFILE, &files) < 0 || files.rlim_cur >= n)
        return;
    files.rlim_cur = files.rlim_max < n ? files.rlim_max : n;
    setrlimit(RLIMIT_NOFILE, &files); /* if that fails, accepting pauses while all are used */
}

/* Opens the first device of the list that works. On failure *error is that of the last one. */
static struct render_thread *open_device(struct daemon *daemon,
                                         const struct service_options *options, struct error *error)
{
    struct device_try tries[DEVICE_MOST_TRIES];
    struct render_thread *thread = NULL;
    int n = device_tries(options->device, tries);
    for (int i = 0; i < n && !thread; i++) {
        const struct renderer_options renderer = {
            .device = tries[i].device,
            .n_threads = (unsigned)options->n_native_threads,
            .isa = strcmp(options->native_isa, "auto") == 0 ? NULL : options->native_isa,
            .block_cache = daemon->block_cache};
        thread = render_thread_create(tries[i].kind, &renderer, daemon->completions, error);
        if (!thread && i + 1 < n)
            log_event(LOG_INFO, "no GPU: processors draw", log_text("text", error->text));
    }
    return thread;
}

/* Starts the worker programs and the threads. The worker program that reads cages starts up while
 * the device opens. */
static bool start_threads(struct service *service, struct error *error)
{
    struct daemon *daemon = &service->daemon;
    const struct service_options *options = &service->options;
    const struct limits *limits = &daemon->limits;
    const struct loop_hooks hooks = {after_batch, tick, service};
    if (!(daemon->block_cache = block_cache_create((size_t)limits->spare_memory)))
        return error_set(error, ERROR_SERVER, "no memory for the daemon");
    return (daemon->loop = loop_create(&hooks, error)) && watch_signals(service, error) &&
           workers_init(&daemon->workers, NULL, &limits->workers, limits->assets.memory_budget,
                        error) &&
           (daemon->completions = completions_create(daemon->loop, error)) &&
           (daemon->render_thread = open_device(daemon, options, error)) &&
           (daemon->pool = pool_create("sheend-pool", (unsigned)options->n_threads, 1,
                                       &encode_context, daemon->completions, error)) &&
           (daemon->readers = pool_create("sheend-read", STORE_MAX_BUILDS, 0,
                                          &(struct pool_context){0}, daemon->completions, error)) &&
           (daemon->store =
                store_create(daemon->pool, daemon->readers, daemon->render_thread, &daemon->workers,
                             &daemon->limits.assets, service->single, error));
}

/* Hands to each folder's part what it needs of the others. */
static void connect_rooms(struct service *service)
{
    struct daemon *daemon = &service->daemon;
    const struct limits *limits = &daemon->limits;
    uint64_t max_upload_bytes = limits->assets.memory_budget < limits->session.max_upload
                                    ? limits->assets.memory_budget
                                    : limits->session.max_upload;
    memory_init(&daemon->memory, daemon->store, &limits->assets, service->single,
                daemon->block_cache);
    daemon->requests = (struct request_host){
        .pool = daemon->pool,
        .render_thread = daemon->render_thread,
        .workers = &daemon->workers,
        .block_cache = daemon->block_cache,
        .memory = &daemon->memory,
        .store = daemon->store,
        .models_fd = daemon->requests.models_fd,
        .max_file_bytes = max_upload_bytes,
        .gpu_generation = 1,
    };
    struct session_host *sessions = &daemon->sessions;
    sessions->loop = daemon->loop;
    sessions->render_thread = daemon->render_thread;
    sessions->workers = &daemon->workers;
    sessions->block_cache = daemon->block_cache;
    sessions->store = daemon->store;
    sessions->memory = &daemon->memory;
    sessions->requests = &daemon->requests;
    sessions->asset_limits = &limits->assets;
    sessions->max_upload_bytes = max_upload_bytes;
    sessions->share_models = service->options.share_models;
    sessions->is_private = service->single;
    stats_init(&sessions->stats);
    strangers_init(&sessions->strangers);
}

static bool start(struct service *service, struct error *error)
{
    struct daemon *daemon = &service->daemon;
    const struct service_options *options = &service->options;
    jpeg_keep_defaults();
    if (!start_threads(service, error))
        return false;
    connect_rooms(service);
    if (*options->models &&
        (daemon->requests.models_fd = model_folder_open(options->models, error)) < 0)
        return false;
    allow_descriptors(daemon->limits.max_connections + SERVICE_OWN_DESCRIPTORS);
    if (service->single)
        return open_session(service, options->session_fd, error);
    workers_expect_images(&daemon->workers);
    service->monitor = monitor_create(daemon, options->stuck_s * 1000000, error);
    return service->monitor && open_listeners(service, error);
}

/* Writes the addresses of all listeners, separated by ", ". */
static void list_addresses(const struct service *service, char *text, size_t capacity)
{
    size_t used = 0;
    text[0] = 0;
    for (size_t i = 0; i < service->n_listeners && used < capacity; i++)
        used += (size_t)snprintf(text + used, capacity - used, "%s%s", i ? ", " : "",
                                 listener_text(service->listeners[i]));
}

static void tell_ready(const struct service *service)
{
    char addresses[SERVICE_MAX_LISTENERS * LISTENER_TEXT_BYTES];
    const char *device = render_thread_info(service->daemon.render_thread)->device;
    list_addresses(service, addresses, sizeof addresses);
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
    if (!access || !start(service, error)) {
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
    close_listeners(service);
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
