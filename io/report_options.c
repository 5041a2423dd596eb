/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The options of a report that have a form: ranges of steps, factors.
 * Input: their text. Output: numbers of the study, or an error that says what was expected.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/quantity.h"
#include "io/report_parts.h"

bool calx_report_options_word(const char **list, char *word, size_t size)
{
    if (!*list)
        return false;
    size_t length = strcspn(*list, ",");
    snprintf(word, size, "%.*s", (int)(length < size ? length : size - 1), *list);
    *list = (*list)[length] ? *list + length + 1 : NULL;
    return true;
}

/* "1e-6..1e-4", with or without units: "1 us..0.1 ms". */
static int read_range(const char *option, const char *text, const char *unit, double *low, double *high,
                      struct calx_error *error)
{
    struct calx_error why;
    char first[64];
    const char *dots = strstr(text, "..");
    *low = *high = NAN;
    if (!dots || (size_t)(dots - text) >= sizeof first)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "%s needs two %s with two points between, as in 1e-6..1e-4, not '%s'",
                              option, *unit == 's' ? "steps" : "numbers", text);
    snprintf(first, sizeof first, "%.*s", (int)(dots - text), text);
    if (calx_quantity_parse(first, unit, low, &why) || calx_quantity_parse(dots + 2, unit, high, &why))
        return calx_error_set(error, CALX_ERROR_INPUT, "%s: %.300s", option, why.text);
    if (*low > 0 && *low <= *high)
        return CALX_OK;
    return calx_error_set(error, CALX_ERROR_INPUT,
                          "%s %s: expected a first one above 0 and not above the second", option, text);
}

static int read_factors(struct calx_report_study *s, struct calx_error *error)
{
    const char *list = s->options->soften;
    char word[64], *end;
    while (calx_report_options_word(&list, word, sizeof word)) {
        double factor = strtod(word, &end);
        if (end == word || *end || !(factor > 1) || !(factor <= 1e6) ||
            s->soften_count == CALX_REPORT_RANGE)
            return calx_error_set(error, CALX_ERROR_INPUT,
                                  "--soften needs up to %d factors above 1 and at most 1e6 with commas between, as in "
                                  "10,100, not '%s'", CALX_REPORT_RANGE, s->options->soften);
        s->soften[s->soften_count++] = 1 / factor;
    }
    return CALX_OK;
}

int calx_report_options_read(struct calx_report_study *s, struct calx_error *error)
{
    const struct calx_report_options *o = s->options;
    s->low = s->high = s->heat_low = s->heat_high = s->tight = s->loose = NAN;
    if (o->steps)
        CALX_TRY(read_range("--steps", o->steps, "s", &s->low, &s->high, error));
    if (o->heat_steps)
        CALX_TRY(read_range("--heat-steps", o->heat_steps, "s", &s->heat_low, &s->heat_high, error));
    if (o->tolerances)
        CALX_TRY(read_range("--tolerances", o->tolerances, "1", &s->tight, &s->loose, error));
    return read_factors(s, error);
}
