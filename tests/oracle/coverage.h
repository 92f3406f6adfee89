/* Compares which pixels of a frame show the surface, which Ptex face and which depth, with a
 * reference picture rasterised from cells of two pixels of libosd's surface. Pixels more than one
 * pixel away from the reference's silhouettes and face borders must agree. */
#ifndef SHEEN_TESTS_ORACLE_COVERAGE_H
#define SHEEN_TESTS_ORACLE_COVERAGE_H

#include "tests/oracle/model.h"
#include "tests/oracle/render.h"
#include "tests/oracle/verdict.h"
#include "tests/oracle/view.h"

/* Prints the column heads for judge_coverage(). */
void print_coverage_header();
/* Needs the planes P and ptex. */
void judge_coverage(const model &model, const view &view, const planes &planes, verdict *verdict);

#endif
