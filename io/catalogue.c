/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Prints plugins: the list, the reference of one, the conformance of a file. Everything comes from
 * the plugins' own descriptors and tables, so that it cannot differ from what calx accepts.
 */
#include "io/catalogue.h"

#include <stdbool.h>
#include <string.h>

#include "core/conform.h"

static const char *plural(size_t n)
{
    return n == 1 ? "" : "s";
}

/* ---- list ---- */

static void list_kind(FILE *out, const struct calx_registry *r, enum calx_kind kind)
{
    bool first = true;
    for (size_t i = 0; i < calx_registry_count(r); i++) {
        const struct calx_plugin *p = calx_registry_at(r, i);
        if (p->kind != kind)
            continue;
        if (first)
            fprintf(out, "%s\n", calx_kind_name(kind));
        first = false;
        fprintf(out, "  %-18s %s\n", p->name, p->summary);
    }
}

int calx_catalogue_list(FILE *out, struct calx_registry *r, struct calx_error *error)
{
    if (calx_registry_load_all(r, stderr) == 0)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "no plugin found: set CALX_PLUGINS to the folder that holds files "
                              "like contact-linear.so");
    for (int kind = CALX_CONTACT; kind <= CALX_TEMPERATURE; kind++)
        list_kind(out, r, (enum calx_kind)kind);
    fprintf(out, "\n`calx plugins NAME` prints the equation and the parameters of one.\n");
    return 0;
}

/* ---- one ---- */

/* A text of several lines, each under the one before. */
static void print_block(FILE *out, const char *title, const char *text)
{
    fprintf(out, "  %-11s", title);
    for (const char *p = text; *p; p++) {
        fputc(*p, out);
        if (*p == '\n')
            fprintf(out, "  %-11s", "");
    }
    fputc('\n', out);
}

static void format_value(const struct calx_parameter *row, double v, char *text, size_t size)
{
    if (row->flags & CALX_SWITCH) {
        snprintf(text, size, "%s", v > 0 ? "yes" : "no");
    } else if (row->flags & CALX_CHOICE) {
        const char *word = row->choices;
        for (int k = 0; k < (int)v && strchr(word, '|'); k++)
            word = strchr(word, '|') + 1;
        snprintf(text, size, "%.*s", (int)strcspn(word, "|"), word);
    } else
        snprintf(text, size, "%g", v);
}

static void print_range(FILE *out, const struct calx_parameter *row)
{
    if (row->flags & CALX_SWITCH)
        fprintf(out, "no or yes");
    else if (row->flags & CALX_CHOICE)
        for (const char *p = row->choices; *p; p++)
            *p == '|' ? (void)fputs(" or ", out) : (void)fputc(*p, out);
    else
        fprintf(out, "%s%g to %s%g", row->flags & CALX_OPEN_MIN ? "above " : "", row->min,
                row->flags & CALX_OPEN_MAX ? "below " : "", row->max);
}

static void print_parameter(FILE *out, const struct calx_parameter *row)
{
    static const char *const scopes[] = {[CALX_RUN] = "one value for the run",
                                         [CALX_MATERIAL] = "of <material>",
                                         [CALX_PAIR] = "a <pair> may override it"};
    char value[64];
    format_value(row, row->initial, value, sizeof value);
    fprintf(out, "\n  %s (%s", row->name, row->symbol);
    if (strcmp(row->unit, "1") != 0)
        fprintf(out, ", %s", row->unit);
    fprintf(out, ")\n    %s\n    ", row->doc);
    print_range(out, row);
    if (row->flags & CALX_REQUIRED)
        fprintf(out, "; must be given");
    else if (row->flags & CALX_OPTIONAL)
        fprintf(out, "; may be left out");
    else
        fprintf(out, "; %s if not given", value);
    fprintf(out, "; %s\n", scopes[row->scope]);
}

static void print_needs(FILE *out, const struct calx_demand *demand)
{
    static const struct {
        uint32_t need;
        const char *text;
    } needs[] = {
        {CALX_NEEDS_TANGENT, "tangential velocity"}, {CALX_NEEDS_ROTATION, "rotation"},
        {CALX_NEEDS_TEMPERATURE, "temperatures"},    {CALX_NEEDS_NORMAL_FORCE, "normal force"},
        {CALX_NEEDS_SPIN, "relative spin"},          {CALX_USES_VELOCITY, "velocities"},
    };
    const char *separator = "  needs      ";
    for (size_t k = 0; k < sizeof needs / sizeof *needs; k++)
        if (demand->needs & needs[k].need) {
            fprintf(out, "%s%s", separator, needs[k].text);
            separator = ", ";
        }
    size_t numbers = 3 * demand->history_vectors + demand->history_scalars;
    if (numbers > 0) {
        fprintf(out, "%sup to %zu number%s per contact", separator, numbers, plural(numbers));
        separator = ", ";
    }
    if (separator[0] == ',')
        fputc('\n', out);
}

static void print_contact(FILE *out, const void *law)
{
    print_needs(out, &((const struct calx_contact_law *)law)->demand);
}

static void print_conductance(FILE *out, const void *law)
{
    print_needs(out, &((const struct calx_conductance_law *)law)->demand);
}

static void print_motion(FILE *out, const void *law)
{
    const struct calx_motion_integrator *l = law;
    fprintf(out, "  accuracy   order %u, ", l->order);
    if (l->stages)
        fprintf(out, "%u force evaluation%s per step", l->stages, plural(l->stages));
    else
        fprintf(out, "sub-steps of its own");
    fprintf(out, ", stable for omega dt < %g, c/m dt < %g%s%s\n", l->stability, l->damping,
            l->reversible ? ", reversible" : "", l->symplectic ? ", symplectic" : "");
    if (l->resolves_contacts)
        fprintf(out, "  resolves onset and end of contacts inside a step\n");
}

static void print_temperature(FILE *out, const void *law)
{
    const struct calx_temperature_integrator *l = law;
    if (l->exact)
        fprintf(out, "  accuracy   exact while the network stays, ");
    else
        fprintf(out, "  accuracy   order %u, ", l->order);
    if (l->unconditional)
        fprintf(out, "stable for any step\n");
    else
        fprintf(out, "stable for lambda dt < %g\n", l->stability);
}

static void (*const print_law[])(FILE *, const void *) = {
    [CALX_CONTACT] = print_contact,
    [CALX_CONDUCTANCE] = print_conductance,
    [CALX_MOTION] = print_motion,
    [CALX_TEMPERATURE] = print_temperature,
};

static void print_plugin(FILE *out, const struct calx_registry *r, const struct calx_plugin *p)
{
    fprintf(out, "%s \"%s\": %s\n", calx_kind_name((enum calx_kind)p->kind), p->name, p->summary);
    print_block(out, "equation", p->equation);
    print_block(out, "reference", p->reference);
    print_law[p->kind](out, p->law);
    fprintf(out, "  file       %s\n", calx_registry_path(r, p));
    for (size_t i = 0; i < p->parameter_count; i++)
        print_parameter(out, &p->parameters[i]);
    if (p->parameter_count == 0)
        fprintf(out, "\n  no parameters\n");
}

int calx_catalogue_show(FILE *out, struct calx_registry *r, const char *name,
                        struct calx_error *error)
{
    const char *names[256];
    size_t count = 0, shown = 0;
    calx_registry_load_all(r, stderr);
    for (size_t i = 0; i < calx_registry_count(r); i++) {
        const struct calx_plugin *p = calx_registry_at(r, i);
        if (count < sizeof names / sizeof *names)
            names[count++] = p->name;
        if (strcmp(p->name, name) != 0)
            continue;
        if (shown++ > 0)
            fputc('\n', out);
        print_plugin(out, r, p);
    }
    if (shown > 0)
        return 0;
    const char *nearest = calx_error_nearest(name, names, count);
    return calx_error_set(
        error, CALX_ERROR_INPUT, "no plugin \"%s\"%s%s%s; `calx plugins` lists all", name,
        nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
}

/* ---- conformance ---- */

int calx_catalogue_check(FILE *out, struct calx_registry *r, const char *path,
                         struct calx_error *error)
{
    const struct calx_plugin *p = calx_registry_load(r, path, error);
    struct calx_conformance report;
    if (!p)
        return CALX_ERROR_INPUT;
    CALX_TRY(calx_conform_run(p, &report, error));
    fprintf(out, "%s \"%s\" (%s)\n", calx_kind_name((enum calx_kind)p->kind), p->name, path);
    for (size_t k = 0; k < report.count; k++) {
        const struct calx_check *c = &report.checks[k];
        fprintf(out, "  %-6s  %-48s %10.3g  bound %-8.3g%s%s\n", c->passed ? "ok" : "FAILED",
                c->name, c->figure, c->bound, c->passed || !c->where[0] ? "" : "  at ",
                c->passed ? "" : c->where);
    }
    if (report.failed == 0) {
        fprintf(out, "%zu check%s passed\n", report.count, plural(report.count));
        return 0;
    }
    return calx_error_set(error, CALX_ERROR_PHYSICS, "%s: %zu of %zu checks failed", path,
                          report.failed, report.count);
}
