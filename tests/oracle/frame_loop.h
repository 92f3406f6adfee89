/* What every oracle that judges frames does first: read each model, look at it from each view, run
 * `sheen render`, and hand model, view and planes over. */
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

/* Runs `sheen render` for one view of a model and reads the planes named in `aov`. A view that
 * sheen chooses gets its camera from --json. Returns what went wrong, empty when nothing did;
 * *exit_code is the program's. */
std::string render_view(const std::string &sheen, const std::string &model_path, view *view,
                        const std::string &aov, const std::vector<std::string> &more_options,
                        planes *planes, int *exit_code);

using view_list = std::function<std::vector<view>(const model &)>;

/* For every model and each of its views. Every failure counts. */
void for_each_frame(const std::string &sheen, const std::vector<std::string> &models,
                    const view_list &views, verdict *verdict, const frame_judge &judge);

#endif
