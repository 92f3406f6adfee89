#include "client/cli/output/junit.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "protocol/text.h"

static const char REPLACEMENT[] = "\xef\xbf\xbd"; /* U+FFFD */

/* XML has no noncharacters U+FFFE and U+FFFF. */
static bool is_noncharacter(const char *text, size_t length)
{
    const unsigned char *c = (const unsigned char *)text;
    return length == 3 && c[0] == 0xef && c[1] == 0xbf && c[2] >= 0xbe;
}

/* Writes text as the value of an attribute or as content. */
static void put(FILE *out, const char *text, bool is_attribute)
{
    while (*text) {
        unsigned char c = (unsigned char)*text;
        size_t length = text_utf8_length(text);
        if (c == '<')
            fputs("&lt;", out);
        else if (c == '>')
            fputs("&gt;", out);
        else if (c == '&')
            fputs("&amp;", out);
        else if (c == '"')
            fputs("&quot;", out);
        else if ((c == '\n' || c == '\t') && is_attribute)
            fprintf(out, "&#%d;", c);
        else if (length == 0 || (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f ||
                 is_noncharacter(text, length))
            fputs(REPLACEMENT, out);
        else
            fwrite(text, 1, length, out);
        text += length ? length : 1;
    }
}

static void put_attribute(FILE *out, const char *name, const char *value)
{
    fprintf(out, " %s=\"", name);
    put(out, value, true);
    fputc('"', out);
}

static void put_case(FILE *out, const struct junit_case *test, const char *suite)
{
    fputs("    <testcase", out);
    put_attribute(out, "name", test->name);
    put_attribute(out, "classname", suite);
    if (!test->failure) {
        fputs(" time=\"0\"/>\n", out);
        return;
    }
    const char *element = test->is_error ? "error" : "failure";
    fprintf(out, " time=\"0\">\n      <%s", element);
    put_attribute(out, "message", test->failure);
    put_attribute(out, "type", test->is_error ? "error" : "limit");
    fputc('>', out);
    put(out, test->details ? test->details : test->failure, false);
    fprintf(out, "</%s>\n    </testcase>\n", element);
}

static void put_suite(FILE *out, const struct junit_suite *suite, size_t id, const char *when)
{
    size_t failures = 0, errors = 0;
    for (size_t i = 0; i < suite->n_cases; i++)
        if (suite->cases[i].failure)
            (*(suite->cases[i].is_error ? &errors : &failures))++;
    fputs("  <testsuite", out);
    put_attribute(out, "name", suite->name);
    fprintf(out,
            " package=\"sheen\" id=\"%zu\" timestamp=\"%s\" hostname=\"localhost\" tests=\"%zu\" "
            "failures=\"%zu\" errors=\"%zu\" time=\"%.3f\">\n    <properties/>\n",
            id, when, suite->n_cases, failures, errors, suite->seconds);
    for (size_t i = 0; i < suite->n_cases; i++)
        put_case(out, &suite->cases[i], suite->name);
    fputs("    <system-out/>\n    <system-err/>\n  </testsuite>\n", out);
}

char *junit_write(const struct junit_suite *suites, size_t n_suites, int64_t when_s,
                  size_t *n_bytes)
{
    char *text = NULL, when[32];
    struct tm parts;
    const time_t seconds = (time_t)when_s;
    FILE *out = open_memstream(&text, n_bytes);
    if (!out)
        return NULL;
    gmtime_r(&seconds, &parts);
    strftime(when, sizeof when, "%Y-%m-%dT%H:%M:%S", &parts);
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n", out);
    for (size_t i = 0; i < n_suites; i++)
        put_suite(out, &suites[i], i, when);
    fputs("</testsuites>\n", out);
    bool ok = !ferror(out);
    if (fclose(out) == 0 && ok)
        return text;
    free(text);
    return NULL;
}
