/* The loop of all oracles that judge frames: read each model, choose views, run `sheen render`, and
 * pass model, view and planes on. */
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

using view_list = std::function<std::vector<view>(const model &)>;

/* Calls the function for every model and each of its views. Every failure is counted. */
void for_each_frame(const std::string &sheen, const std::vector<std::string> &models,
                    const view_list &views, verdict *verdict, const frame_judge &judge);

#endif
