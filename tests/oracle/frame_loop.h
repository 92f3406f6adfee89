/* How oracles get a frame by `sheen render`, and the loop of those that judge frames of many models:
 * read each model, choose views, draw, and pass model, view and planes on. */
#ifndef SHEEN_TESTS_ORACLE_FRAME_LOOP_H
#define SHEEN_TESTS_ORACLE_FRAME_LOOP_H

#include <functional>
#include <string>
#include <vector>

#include "tests/oracle/model.h"
#include "tests/oracle/render.h"
#include "tests/oracle/verdict.h"
#include "tests/oracle/view.h"

using frame_judge = std::function<void(const model &, const view &, const planes &)>;

/* Runs `sheen render` for one view of a model and reads the planes named in `aov`. The camera of a
 * view that sheen chooses is read from --json. Returns an error text, empty on success; *exit_code
 * is the program's. */
std::string render_view(const std::string &sheen, const std::string &model_path, view *view,
                        const std::string &aov, const std::vector<std::string> &more_options,
                        planes *planes, int *exit_code);

/* Draws one view, and fills in its camera if sheen chooses it. Returns an error text, empty on success. */
using frame_source = std::function<std::string(const model &, view *, planes *)>;
/* By `sheen render`. */
frame_source frames_by_command(const std::string &sheen);
/* By libsheen from the daemon at $SHEEN_SERVER; no file is written or read. */
frame_source frames_by_library();

using view_list = std::function<std::vector<view>(const model &)>;

/* Calls the function for every model and each of its views. Every failure is counted. */
void for_each_frame(const frame_source &draw, const std::vector<std::string> &models,
                    const view_list &views, verdict *verdict, const frame_judge &judge);

#endif
