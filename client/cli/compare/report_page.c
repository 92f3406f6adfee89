#include "client/cli/compare/report_page.h"

#include <math.h>
#include <string.h>

const char REPORT_STYLE[] =
    "body { font: 15px/1.4 sans-serif; margin: 1.5em; color: #222; background: #fff }\n"
    "h1 { font-size: 1.4em } h2 { font-size: 1.2em; border-top: 1px solid #bbb; padding-top: .8em "
    "}\n"
    "table { border-collapse: collapse } td, th { padding: .2em .7em; border: 1px solid #ccc; "
    "text-align: right }\n"
    "td:first-child, th:first-child { text-align: left }\n"
    ".out { background: #fbd0d0; font-weight: bold } .same { color: #070 } .bad { color: #b00 }\n"
    "figure { display: inline-block; margin: .5em } figcaption { font-size: .85em }\n"
    "img { display: block; max-width: 100%; height: auto }\n"
    ".frame { position: relative; overflow: hidden } .frame .over { position: absolute; left: 0; "
    "top: 0; "
    "animation: blink 1.2s steps(1) infinite }\n"
    "@keyframes blink { 0% { opacity: 1 } 50% { opacity: 0 } }\n"
    "@media (prefers-reduced-motion: reduce) { .frame .over { animation: none } "
    ".frame:hover .over { opacity: 0 } }\n";

/* All pictures of a view show the same part: the wheel zooms about the pointer, dragging moves, a double click ends it. */
const char REPORT_SCRIPT[] =
    "document.querySelectorAll('.view').forEach(view => {\n"
    "  const frames = view.querySelectorAll('.frame');\n"
    "  let scale = 1, x = 0, y = 0, from = null;\n"
    "  const show = () => {\n"
    "    frames.forEach(frame => {\n"
    "      x = Math.min(0, Math.max(x, frame.clientWidth * (1 - scale)));\n"
    "      y = Math.min(0, Math.max(y, frame.clientHeight * (1 - scale)));\n"
    "    });\n"
    "    view.querySelectorAll('.frame img').forEach(image => {\n"
    "      image.style.transformOrigin = '0 0';\n"
    "      image.style.imageRendering = scale > 2 ? 'pixelated' : 'auto';\n"
    "      image.style.transform = `translate(${x}px,${y}px) scale(${scale})`;\n"
    "    });\n"
    "  };\n"
    "  frames.forEach(frame => {\n"
    "    frame.addEventListener('wheel', event => {\n"
    "      event.preventDefault();\n"
    "      const box = frame.getBoundingClientRect();\n"
    "      const next = Math.min(32, Math.max(1, scale * Math.pow(1.002, -event.deltaY)));\n"
    "      const px = event.clientX - box.left, py = event.clientY - box.top;\n"
    "      x = px - (px - x) * next / scale;\n"
    "      y = py - (py - y) * next / scale;\n"
    "      scale = next;\n"
    "      show();\n"
    "    }, {passive: false});\n"
    "    frame.addEventListener('pointerdown', event => {\n"
    "      event.preventDefault();\n"
    "      frame.setPointerCapture(event.pointerId);\n"
    "      from = [event.clientX - x, event.clientY - y];\n"
    "    });\n"
    "    frame.addEventListener('pointermove', event => {\n"
    "      if (!from) return;\n"
    "      x = event.clientX - from[0];\n"
    "      y = event.clientY - from[1];\n"
    "      show();\n"
    "    });\n"
    "    frame.addEventListener('pointerup', () => { from = null; });\n"
    "    frame.addEventListener('dblclick', () => { scale = 1; x = y = 0; show(); });\n"
    "  });\n"
    "});\n";

/* Text of HTML. Control characters, which HTML has not, become '?'. */
static void put_text(FILE *page, const char *text)
{
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '<' || c == '>' || c == '&' || c == '"' || c == '\'')
            fprintf(page, "&#%d;", c);
        else
            fputc(c < 0x20 || c == 0x7f ? '?' : c, page);
    }
}

static void put_table(FILE *page, const struct compared_pair *pair)
{
    fputs("<table><tr><th></th><th>worst</th><th>limit</th><th>area beyond, "
          "%</th><th>where</th></tr>\n",
          page);
    for (int k = 0; k < COMPARISON_ITEMS; k++) {
        enum comparison_item item = (enum comparison_item)k;
        const struct comparison_limit *limit = &pair->limits[k];
        double value = comparison_value(pair, item);
        char line[COMPARISON_LINE_BYTES], text[32] = "-";
        if (isnan(value))
            continue;
        if (!limit->is_off && isfinite(limit->value))
            snprintf(text, sizeof(text), "%.6g", limit->value);
        comparison_line(pair, item, line);
        const char *where = strstr(line, ", at ");
        fprintf(page, "<tr%s><td>%s</td><td>%.6g</td><td>%s</td><td>%.4g</td><td>%s</td></tr>\n",
                pair->out >> k & 1 ? " class=\"out\"" : "", comparison_key(item), value, text,
                100 * comparison_share_out(pair, item), where ? where + 5 : "");
    }
    fputs("</table>\n", page);
}

static void put_image(FILE *page, const char *class_name, const char *source, const char *what)
{
    fprintf(page, "<img%s src=\"%s\" alt=\"%s\" width=\"%d\" height=\"%d\">", class_name, source,
            what, REPORT_WIDTH_PX, REPORT_HEIGHT_PX);
}

static void put_map(FILE *page, const struct report_view *view, enum report_picture map)
{
    const char *what = map == PICTURE_ANGLE ? "angle of the normals" : "distance along the normal";
    fputs("<figure><div class=\"frame\">", page);
    put_image(page, "", view->source[map], what);
    fprintf(page,
            "</div><img src=\"%s\" alt=\"scale\"><figcaption>%s: black 0, white %.4g %s and more; "
            "grey: no surface; magenta: on one side only</figcaption></figure>\n",
            view->scale, what, view->most[map], map == PICTURE_ANGLE ? "degrees" : "units");
}

void report_page_view(FILE *page, const struct report_view *view)
{
    const char *moved = view->is_aligned ? ", moved onto old" : "";
    fputs("<section class=\"view\"><h3>", page);
    put_text(page, view->title);
    fputs("</h3>\n", page);
    for (int k = PICTURE_OLD; k <= PICTURE_NEW; k++) {
        fputs("<figure><div class=\"frame\">", page);
        put_image(page, "", view->source[k], k ? "new" : "old");
        fprintf(page, "</div><figcaption>%s%s</figcaption></figure>\n", k ? "new" : "old",
                k ? moved : "");
    }
    fputs("<figure><div class=\"frame\">", page);
    put_image(page, "", view->source[PICTURE_NEW], "new");
    put_image(page, " class=\"over\"", view->source[PICTURE_OLD], "old");
    fprintf(page, "</div><figcaption>old and new%s in turn</figcaption></figure>\n", moved);
    put_map(page, view, PICTURE_ANGLE);
    put_map(page, view, PICTURE_DISTANCE);
    fputs("</section>\n", page);
}

void report_page_pair(FILE *page, const struct compared_pair *pair, size_t p)
{
    bool is_same = pair->verdict == COMPARISON_SAME;
    fprintf(page, "<h2 id=\"p%zu\">", p);
    put_text(page, pair->name);
    fprintf(page, ": <span class=\"%s\">%s</span></h2>\n", is_same ? "same" : "bad",
            comparison_verdict_text(pair));
    if (pair->verdict == COMPARISON_FAILED) {
        fputs("<p>", page);
        put_text(page, pair->failure);
        fputs("</p>\n", page);
    }
    if (comparison_is_made(pair))
        put_table(page, pair);
}

static void put_overview(FILE *page, const struct compared_pair *pairs, size_t n)
{
    char counts[COMPARISON_COUNTS_BYTES];
    comparison_counts(pairs, n, counts);
    fprintf(page, "<h1>sheen compare: %s</h1>\n<ul>\n", counts);
    for (size_t i = 0; i < n; i++) {
        fprintf(page, "<li><a href=\"#p%zu\">", i);
        put_text(page, pairs[i].name);
        fprintf(page, "</a>: %s</li>\n", comparison_verdict_text(&pairs[i]));
    }
    fputs("</ul>\n", page);
}

void report_page_begin(FILE *page, const struct compared_pair *pairs, size_t n, bool is_single)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>sheen "
          "compare</title>\n",
          page);
    if (is_single)
        fprintf(page,
                "<style>\n%s</style>\n<script>\naddEventListener('DOMContentLoaded', () => "
                "{\n%s});\n</script>\n",
                REPORT_STYLE, REPORT_SCRIPT);
    else
        fputs("<link rel=\"stylesheet\" href=\"style.css\"><script src=\"zoom.js\" "
              "defer></script>\n",
              page);
    fputs("</head><body>\n", page);
    put_overview(page, pairs, n);
}

void report_page_end(FILE *page)
{
    fputs("</body></html>\n", page);
}
