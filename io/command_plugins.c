/* SPDX-License-Identifier: BSD-3-Clause
 *
 * `calx plugins`: lists the plugins, prints the reference of one, or checks a file against the
 * contract. Input: the command line. Output: text on stdout; exit status 1 if a check failed.
 */
#include <stdio.h>

#include "io/catalogue.h"
#include "io/commands.h"

static int answer(const struct calx_arguments *a, struct calx_registry *registry,
                  struct calx_error *error)
{
    if (a->check && a->operand_count)
        return calx_error_set(error, CALX_ERROR_INPUT, "give a name or --check FILE.so, not both");
    if (a->check)
        return calx_catalogue_check(stdout, registry, a->check, error);
    if (a->operand_count)
        return calx_catalogue_show(stdout, registry, a->operands[0], error);
    return calx_catalogue_list(stdout, registry, error);
}

static int plugins(const struct calx_arguments *a)
{
    struct calx_error error;
    struct calx_registry *registry = calx_registry_create(NULL);
    int code = registry ? answer(a, registry, &error)
                        : calx_error_set(&error, CALX_ERROR_MEMORY, "out of memory");
    int status = code == CALX_OK ? 0 : calx_options_report(&error);
    calx_registry_free(registry);
    return status;
}

#define OPTIONS 1
static const struct calx_option *const used[OPTIONS] = {&calx_option_check};

const struct calx_command calx_command_plugins = {
    "plugins",
    "[NAME | --check FILE.so]",
    "list the models, explain one, or check a new one",
    "Looks in the folders of $CALX_PLUGINS, beside the program and where calx is installed.\n\n"
    "examples:\n"
    "  calx plugins\n"
    "  calx plugins coulomb\n"
    "  calx plugins --check ./contact-mine.so\n",
    OPTIONS,
    used,
    0,
    1,
    plugins,
};
