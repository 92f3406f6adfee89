#include "client/cli/notices.h"

#include <stdio.h>

void notices_ask(struct client *client, const struct options *options,
                 struct sheen_model_info *info)
{
    struct sheen_error error;
    if (sheen_query_model(client->session, client->model_id, &client->report, info, &error) ==
        SHEEN_OK)
        return;
    *info = (struct sheen_model_info)SHEEN_MODEL_INFO_DEFAULTS;
    snprintf(info->warnings, sizeof(info->warnings), "%.1000s: its warnings are unknown: %s",
             options->model, error.text);
}

/* Advice if few rays meet the light. */
static const char *light_advice(const struct sheen_request *request)
{
    bool is_placed = false;
    for (uint32_t i = 0; i < request->n_lights; i++)
        is_placed = is_placed || request->lights[i].is_placed;
    return is_placed ? "move it with --light-center, --light-u and --light-v, or leave these and "
                       "--light out for a tunnel, which is met everywhere"
                     : "--light tunnel, or no --light, is met everywhere; or place it with "
                       "--light-center, --light-u and --light-v";
}

void notices_print_model(struct client *client, const struct options *options,
                         const struct sheen_frame *frame, const struct sheen_model_info *info)
{
    if (options->quiet)
        return;
    client_print_warnings(client, info->warnings);
    if (frame->up_source == SHEEN_UP_GUESSED)
        progress_note(&client->progress,
                      "up is taken as %s (a guess from the model's box); if that is wrong, give "
                      "--up %s or another direction",
                      frame->up[2] != 0 ? "z" : "y", frame->up[2] != 0 ? "y" : "z");
}

void notices_print(struct client *client, const struct options *options,
                   const struct sheen_frame *frame, const struct sheen_model_info *info)
{
    if (options->quiet)
        return;
    notices_print_model(client, options, frame, info);
    if (frame->blank)
        fprintf(stderr, "sheen: warning: no pixel shows the surface: see --eye, --target, --zoom, "
                        "--fov and --ortho; without them a camera frames the model\n");
    if (frame->light_share < 0.5)
        progress_note(&client->progress, "the light is met on %.2g %% of what is seen: %s",
                      100 * frame->light_share, light_advice(&options->request));
}
