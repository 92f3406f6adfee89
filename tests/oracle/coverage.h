/* Which pixels of a frame are hit, by which Ptex face and at which depth, against a reference
 * picture rasterised from cells of two pixels of libosd's surface. Whatever is more than one pixel
 * from the reference's silhouette or face borders must agree. */
#ifndef SHEEN_TESTS_ORACLE_COVERAGE_H
#define SHEEN_TESTS_ORACLE_COVERAGE_H

#include "tests/oracle/model.h"
#include "tests/oracle/render.h"
#include "tests/oracle/verdict.h"
#include "tests/oracle/view.h"

/* The columns of the lines that judge_coverage() prints. */
void print_coverage_header();
/* Needs the planes P and ptex. */
void judge_coverage(const model &model, const view &view, const planes &planes, verdict *verdict);

#endif
