/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The program calx: picks the subcommand.
 * Input: argv. Output: the exit status: 0 right, 1 physics or expectation failed, 2 bad input or
 * usage.
 */
#include <locale.h>
#include <stdio.h>
#include <string.h>

#include "core/calx.h"
#include "io/commands.h"

static const struct calx_command *const commands[] = {
    &calx_command_run,     &calx_command_check,  &calx_command_verify,
    &calx_command_report,  &calx_command_bench,  &calx_command_plugins,
    &calx_command_schema,
};

enum { COMMANDS = sizeof commands / sizeof commands[0], EXIT_USAGE = 2 };

static void print_help(FILE *file)
{
    fprintf(file, "calx " CALX_VERSION ": hot granular matter by the discrete element method\n\n"
                  "usage: calx COMMAND ...   (calx COMMAND --help says more)\n\n");
    for (size_t i = 0; i < COMMANDS; ++i)
        fprintf(file, "  %-8s %-34s %s\n", commands[i]->name, commands[i]->operands,
                commands[i]->summary);
    fprintf(file,
            "\n  --help     this text\n  --version  the version\n\n"
            "examples:\n"
            "  calx run cases/04-two-spheres\n"
            "  calx check cases/07-drum-with-flights\n"
            "  calx plugins linear\n\n"
            "quantities for probes and expectations: calx schema --reference\n"
            "exit status: 0 right, 1 physics or an expectation failed, 2 bad input or usage\n");
}

static int unknown_command(const char *name)
{
    const char *names[COMMANDS];
    for (size_t i = 0; i < COMMANDS; ++i)
        names[i] = commands[i]->name;
    const char *nearest = calx_error_nearest(name, names, COMMANDS);
    fprintf(stderr, "calx: error: no command '%s'", name);
    if (nearest)
        fprintf(stderr, "; did you mean '%s'?", nearest);
    fprintf(stderr, " (see calx --help)\n");
    return EXIT_USAGE;
}

static int run_command(const struct calx_command *command, int argc, char **argv)
{
    struct calx_arguments arguments;
    struct calx_error error;
    int status = 0;
    if (calx_options_parse(command, argc, argv, &arguments, &error) != CALX_OK)
        status = calx_options_report(&error);
    else if (arguments.help)
        calx_options_print_help(command, stdout);
    else
        status = command->run(&arguments);
    calx_options_clear(&arguments);
    return status;
}

int main(int argc, char **argv)
{
    setlocale(LC_ALL, "C"); /* numbers have points */
    const char *word = argc > 1 ? argv[1] : "";
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0 || strcmp(word, "help") == 0) {
        print_help(stdout);
        return 0;
    }
    if (strcmp(word, "--version") == 0) {
        puts("calx " CALX_VERSION);
        return 0;
    }
    if (argc < 2) {
        print_help(stderr);
        return EXIT_USAGE;
    }
    for (size_t i = 0; i < COMMANDS; ++i)
        if (strcmp(word, commands[i]->name) == 0)
            return run_command(commands[i], argc - 1, argv + 1);
    return unknown_command(word);
}
