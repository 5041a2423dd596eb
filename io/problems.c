/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Gathers the mistakes and warnings of an input file. Input: places and texts. Output: the list,
 * printed in the form that editors and compilers' users know, "file:line: text".
 */
#include "io/problems.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static bool is_listed(const struct calx_error *list, size_t count, const struct calx_error *e)
{
    for (size_t k = 0; k < count; k++)
        if (list[k].line == e->line && strcmp(list[k].text, e->text) == 0 &&
            strcmp(list[k].file, e->file) == 0)
            return true;
    return false;
}

/* Whether e is in the list afterwards. */
static bool keep(struct calx_error **list, size_t *count, const struct calx_error *e)
{
    struct calx_error *grown = realloc(*list, (*count + 1) * sizeof **list);
    if (!grown)
        return false;
    grown[*count] = *e;
    *list = grown;
    ++*count;
    return true;
}

void calx_problems_add_error(struct calx_problems *problems, const struct calx_error *e)
{
    if (is_listed(problems->list, problems->kept, e))
        return;
    problems->count++;
    if (problems->kept < CALX_PROBLEMS_KEPT)
        keep(&problems->list, &problems->kept, e);
}

static void fill(struct calx_error *e, struct calx_place place, const char *format,
                 va_list arguments)
{
    *e = (struct calx_error){.code = CALX_ERROR_INPUT, .line = place.line};
    snprintf(e->file, sizeof e->file, "%s", place.file ? place.file : "");
    vsnprintf(e->text, sizeof e->text, format, arguments);
}

void calx_problems_add(struct calx_problems *problems, struct calx_place place, const char *format,
                       ...)
{
    struct calx_error e;
    va_list arguments;
    va_start(arguments, format);
    fill(&e, place, format, arguments);
    va_end(arguments);
    calx_problems_add_error(problems, &e);
}

void calx_problems_warn(struct calx_problems *problems, struct calx_place place, const char *format,
                        ...)
{
    struct calx_error e;
    va_list arguments;
    va_start(arguments, format);
    fill(&e, place, format, arguments);
    va_end(arguments);
    if (problems->warning_count < CALX_PROBLEMS_KEPT &&
        !is_listed(problems->warnings, problems->warning_count, &e))
        keep(&problems->warnings, &problems->warning_count, &e);
}

void calx_problems_expect(struct calx_problems *problems, const char *part)
{
    char **grown = realloc(problems->refusals, (problems->refusal_count + 1) * sizeof *grown);
    char *copy = grown ? strdup(part) : NULL;
    if (grown)
        problems->refusals = grown;
    if (copy)
        problems->refusals[problems->refusal_count++] = copy;
}

/* By insertion: the list is short, and mistakes of one line keep their order. */
void calx_problems_sort(struct calx_problems *problems)
{
    for (size_t k = 1; k < problems->kept; k++) {
        struct calx_error moving = problems->list[k];
        size_t at = k;
        for (; at && problems->list[at - 1].line > moving.line; at--)
            problems->list[at] = problems->list[at - 1];
        problems->list[at] = moving;
    }
}

static void print_place(const struct calx_error *e, FILE *out)
{
    if (*e->file)
        fprintf(out, "%s:", e->file);
    if (e->line)
        fprintf(out, "%d:", e->line);
    if (*e->file || e->line)
        fputc(' ', out);
}

void calx_problems_print(const struct calx_problems *problems, FILE *out)
{
    for (size_t k = 0; k < problems->kept; k++) {
        print_place(&problems->list[k], out);
        fprintf(out, "%s\n", problems->list[k].text);
    }
    if (problems->count > problems->kept)
        fprintf(out, "... and %zu more mistakes\n", problems->count - problems->kept);
    for (size_t k = 0; k < problems->warning_count; k++) {
        print_place(&problems->warnings[k], out);
        fprintf(out, "warning: %s\n", problems->warnings[k].text);
    }
}

void calx_problems_clear(struct calx_problems *problems)
{
    for (size_t k = 0; k < problems->refusal_count; k++)
        free(problems->refusals[k]);
    free(problems->refusals);
    free(problems->list);
    free(problems->warnings);
    *problems = (struct calx_problems){0};
}
