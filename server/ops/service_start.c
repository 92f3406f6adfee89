/* Devices and threads of the service, and what each room needs of the others. */
#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/assets/model_file.h"
#include "server/base/resident.h"
#include "server/net/http.h"
#include "server/ops/descriptors.h"
#include "server/ops/device_choice.h"
#include "server/ops/notify.h"
#include "server/ops/service_internal.h"
#include "server/output/jpeg.h"
#include "server/sandbox/confine.h"

/* Divides the descriptors that are left. Listeners and programs must be open. */
static void share_descriptors(struct service *service)
{
    struct daemon *daemon = &service->daemon;
    const struct descriptors wanted = {.clients = daemon->limits.max_connections,
                                       .jobs = pool_threads(daemon->pool) + 1 + STORE_MAX_BUILDS,
                                       .probes = HTTP_MAX_CONNECTIONS};
    const struct descriptors shares = descriptors_divide(&wanted);
    bool is_scarce = shares.clients < wanted.clients;
    daemon->most_clients = is_scarce ? shares.clients : UINT64_MAX;
    workers_limit_jobs(&daemon->workers, shares.jobs);
    if (service->monitor)
        monitor_limit(service->monitor, shares.probes);
    if (!service->single && is_scarce)
        log_event(LOG_WARN, "few descriptors: fewer clients than max-connections are taken",
                  log_number("clients", shares.clients), log_number("jobs", shares.jobs));
}

/* Opens the first device of the list that works. On failure *error is that of the last one. */
static struct render_thread *open_device(struct service *service, struct error *error)
{
    struct daemon *daemon = &service->daemon;
    const struct service_options *options = &service->options;
    struct device_try tries[DEVICE_MOST_TRIES];
    struct render_thread *thread = NULL;
    int n = device_tries(options->device, tries);
    for (int i = 0; i < n && !thread; i++) {
        const struct renderer_options renderer = {
            .device = tries[i].device,
            .n_threads = (unsigned)options->n_native_threads,
            .warm_up = !service->single,
            .isa = strcmp(options->native_isa, "auto") == 0 ? NULL : options->native_isa,
            .block_cache = daemon->block_cache};
        thread = render_thread_create(tries[i].kind, &renderer, daemon->completions, error);
        if (!thread && i + 1 < n)
            log_event(LOG_INFO, "no GPU: processors draw", log_text("text", error->text));
        service->has_driver = tries[i].has_driver;
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
    if (!(daemon->block_cache = block_cache_create((size_t)limits->spare_memory)))
        return error_set(error, ERROR_SERVER, "no memory for the daemon");
    return service_make_loop(service, error) &&
           workers_init(&daemon->workers, NULL, &limits->workers, limits->assets.memory_budget,
                        error) &&
           (daemon->completions = completions_create(daemon->loop, error)) &&
           (daemon->render_thread = open_device(service, error)) &&
           (daemon->pool = pool_create("sheend-pool", (unsigned)options->n_threads, 1,
                                       &encode_context, daemon->completions, error)) &&
           (daemon->readers = pool_create("sheend-read", STORE_MAX_BUILDS, 0,
                                          &(struct pool_context){0}, daemon->completions, error)) &&
           (daemon->store =
                store_create(daemon->pool, daemon->readers, daemon->render_thread, &daemon->workers,
                             &daemon->limits.assets, service->single, error));
}

/* What the daemon itself takes of the budget, and still takes when it has served for a while: what the device's
 * drivers have taken by now and will take for the programs of usual frames, too. */
static uint64_t daemon_bytes(const struct service *service)
{
    const struct renderer_info *info = render_thread_info(service->daemon.render_thread);
    uint64_t resident = service->has_driver ? resident_bytes() + info->usual_programs_bytes : 0;
    return resident > PROTOCOL_DAEMON_BYTES ? resident : PROTOCOL_DAEMON_BYTES;
}

/* Sets aside what the daemon takes. False if the budget leaves too little. */
static bool divide_budget(struct service *service, struct error *error)
{
    uint64_t own = daemon_bytes(service), budget = service->daemon.limits.assets.memory_budget;
    uint64_t least = own + PROTOCOL_LEAST_MEMORY_BYTES - PROTOCOL_DAEMON_BYTES;
    if (budget < least)
        return error_set(error, ERROR_REQUEST,
                         "memory-budget is %" PRIu64 "; on this device it must be at least %" PRIu64
                         ", of which the daemon and its drivers take %" PRIu64,
                         budget, least, own);
    store_set_daemon_bytes(service->daemon.store, own);
    return true;
}

/* Hands to each folder's part what it needs of the others. */
static void connect_rooms(struct service *service)
{
    struct daemon *daemon = &service->daemon;
    const struct limits *limits = &daemon->limits;
    uint64_t room = store_account(daemon->store)->limit;
    uint64_t max_upload_bytes =
        room < limits->session.max_upload ? room : limits->session.max_upload;
    memory_init(&daemon->memory, daemon->store, &limits->assets, service->single,
                daemon->render_thread, daemon->block_cache);
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
    TAILQ_INIT(&daemon->requests.in_line);
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

/* From here on the daemon can start no program, write no file and open no socket. */
static bool confine(const struct service *service, struct error *error)
{
    return confine_enter(service->has_driver ? CONFINE_DRIVER : CONFINE_COMPUTING) ||
           error_set(error, ERROR_SERVER, "the kernel refuses to confine the daemon (seccomp): %s",
                     strerror(errno));
}

bool service_start(struct service *service, struct error *error)
{
    struct daemon *daemon = &service->daemon;
    const struct service_options *options = &service->options;
    jpeg_keep_defaults();
    if (!start_threads(service, error) || !divide_budget(service, error))
        return false;
    connect_rooms(service);
    if (*options->models &&
        (daemon->requests.models_fd = model_folder_open(options->models, error)) < 0)
        return false;
    daemon->most_clients = 1;
    if (service->single) {
        share_descriptors(service);
        return service_open_session(service, options->session_fd, error) && confine(service, error);
    }
    workers_expect_images(&daemon->workers);
    service->monitor = monitor_create(daemon, options->stuck_s * 1000000, error);
    if (!service->monitor || !service_open_listeners(service, error))
        return false;
    notify_open();
    share_descriptors(service);
    return confine(service, error);
}
