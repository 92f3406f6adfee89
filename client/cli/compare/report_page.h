/* The page of the report of `sheen compare`: its text, style and script. Thread: one. */
#ifndef SHEEN_CLIENT_REPORT_PAGE_H
#define SHEEN_CLIENT_REPORT_PAGE_H

#include <stdio.h>

#include "client/cli/output/comparison.h"

/* The pictures of a view. */
enum report_picture { PICTURE_OLD, PICTURE_NEW, PICTURE_ANGLE, PICTURE_DISTANCE, PICTURES };

struct report_view {
    const char *title;
    char *source[PICTURES]; /* addresses of the pictures */
    const char *scale;      /* address of the picture of the maps' scale */
    double most[PICTURES];  /* of maps: where their scale ends */
    bool is_aligned;        /* the new surface was moved */
};

enum { REPORT_WIDTH_PX = 640, REPORT_HEIGHT_PX = 360 };

extern const char REPORT_STYLE[];  /* style.css */
extern const char REPORT_SCRIPT[]; /* zoom.js: linked zoom; the page needs it for nothing else */

/* The head and the list of pairs. `is_single`: style and script are in the page, instead of beside it. */
void report_page_begin(FILE *page, const struct compared_pair *pairs, size_t n, bool is_single);
/* Pair p: its verdict and its table. */
void report_page_pair(FILE *page, const struct compared_pair *pair, size_t p);
void report_page_view(FILE *page, const struct report_view *view);
void report_page_end(FILE *page);

#endif
