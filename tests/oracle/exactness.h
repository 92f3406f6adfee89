/* Compares every pixel of a frame with libosd in double precision at the pixel's own (face, u, v),
 * and with the camera: the point must lie on its pixel's ray. */
#ifndef SHEEN_TESTS_ORACLE_EXACTNESS_H
#define SHEEN_TESTS_ORACLE_EXACTNESS_H

#include "tests/oracle/model.h"
#include "tests/oracle/render.h"
#include "tests/oracle/tables.h"
#include "tests/oracle/verdict.h"
#include "tests/oracle/view.h"

/* Prints the column heads for judge_exactness(). */
void print_exactness_header();
/* Needs the planes P, N, ptex and k. `tables` are the model's. */
void judge_exactness(const model &model, const table_evaluator &tables, const view &view,
                     const planes &planes, verdict *verdict);

#endif
