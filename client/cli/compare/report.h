/* The report of `sheen compare`: a folder with pages and pictures that a browser shows from any
 * server, also from one that forbids scripts, inline styles and data: addresses. Pictures of both
 * models have the camera, the lights and the lines of the old one, so that what moves between them
 * is the surface; with --align the new one is shown where it was moved to. Where scripts run, all
 * pictures of a view are zoomed together. The maps of angles and distances are painted from pixels,
 * for the eye; the numbers beside them are those of the comparison.
 * Thread: one. */
#ifndef SHEEN_CLIENT_REPORT_H
#define SHEEN_CLIENT_REPORT_H

#include "client/cli/client.h"
#include "client/cli/compare/views.h"
#include "client/cli/output/comparison.h"

/* Makes the folder options->report, or writes into it, and replaces files of the same names. No
 * request is in flight. */
enum sheen_status report_write_folder(struct client *client, const struct options *options,
                                      const struct views *views, const struct compared_pair *pairs,
                                      size_t n);
/* Writes options->html, one file that has all pictures, style and script in itself. */
enum sheen_status report_write_file(struct client *client, const struct options *options,
                                    const struct views *views, const struct compared_pair *pairs,
                                    size_t n);

#endif
