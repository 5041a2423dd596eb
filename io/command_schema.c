/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx schema`: prints the grammar of the case file, for editors.
 * Input: the tables of the case reader and of the plugins. Output: RELAX NG on stdout, or the
 * reference in Markdown.
 */
#include <stdio.h>

#include "io/commands.h"
#include "io/schema.h"

static int write_text(const struct calx_arguments *a, struct calx_registry *registry)
{
    return a->reference ? calx_schema_write_reference(stdout) : calx_schema_write(stdout, registry);
}

static int print_schema(const struct calx_arguments *a)
{
    struct calx_error error;
    struct calx_registry *registry = calx_registry_create(NULL);
    int code = registry ? write_text(a, registry) : CALX_ERROR_MEMORY;
    if (code == CALX_OK && fflush(stdout) != 0)
        code = CALX_ERROR_IO;
    calx_registry_free(registry);
    if (code == CALX_OK)
        return 0;
    calx_error_set(&error, (enum calx_code)code,
                   code == CALX_ERROR_MEMORY ? "out of memory" : "the schema cannot be written");
    return calx_options_report(&error);
}

#define OPTIONS 1
static const struct calx_option *const used[OPTIONS] = {&calx_option_reference};

const struct calx_command calx_command_schema = {
    "schema",
    "[--reference]",
    "print the grammar of the case file (RELAX NG)",
    "examples:\n"
    "  calx schema > calx.rng\n"
    "  xmllint --noout --relaxng calx.rng case.xml\n",
    OPTIONS,
    used,
    0,
    0,
    print_schema,
};
