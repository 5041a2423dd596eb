/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Parses the command line from tables of options and prints their help.
 * Input: argv and a command's table. Output: struct calx_arguments, or an error that names the
 * nearest option. Method: `--name value`, `--name=value`, `--` ends the options; the rest are
 * operands.
 */
#include "io/options.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_THREADS = 1024, MOST_OPTIONS = 16 };
static const long long MOST_STEPS = 1000000000000;

/* ---- the options ---- */

static int set_setting(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    const char *equals = strchr(value, '=');
    if (!equals || equals == value)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "--set needs path=value, as in --set integrator/dt=1e-5, not '%s'",
                              value);
    struct calx_setting *grown = realloc(a->settings, (a->setting_count + 1) * sizeof *grown);
    if (!grown)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    a->settings = grown;
    char *path = strndup(value, (size_t)(equals - value));
    if (!path)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    a->settings[a->setting_count++] = (struct calx_setting){path, equals + 1};
    return CALX_OK;
}

static int set_out(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    if (!*value)
        return calx_error_set(error, CALX_ERROR_INPUT, "--out needs a folder");
    a->out = value;
    return CALX_OK;
}

static int set_threads(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    char *end;
    errno = 0;
    long n = strtol(value, &end, 10);
    if (errno || end == value || *end || n < 1 || n > MOST_THREADS)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "--threads needs a whole number from 1 to %d, not '%s'", MOST_THREADS,
                              value);
    a->threads = (int)n;
    return CALX_OK;
}

static int set_thread_list(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    a->thread_count = 0;
    for (const char *word = value;; ++word) {
        char *end;
        errno = 0;
        long n = strtol(word, &end, 10);
        bool number = !errno && end != word && n >= 1 && n <= MOST_THREADS;
        if (!number || (*end && *end != ',') || a->thread_count == CALX_OPTIONS_THREADS)
            return calx_error_set(error, CALX_ERROR_INPUT,
                                  "--threads needs up to %d whole numbers from 1 to %d with commas "
                                  "between them, as in 1,2, not '%s'",
                                  CALX_OPTIONS_THREADS, MOST_THREADS, value);
        a->thread_list[a->thread_count++] = (int)n;
        if (!*end)
            return CALX_OK;
        word = end;
    }
}

/* A whole number of steps from `least` on. */
static int read_steps(const char *option, const char *value, int64_t least, int64_t *steps,
                      struct calx_error *error)
{
    char *end;
    errno = 0;
    long long n = strtoll(value, &end, 10);
    if (errno || end == value || *end || n < least || n > MOST_STEPS)
        return calx_error_set(error, CALX_ERROR_INPUT,
                              "%s needs a whole number from %lld to %lld, not '%s'", option,
                              (long long)least, MOST_STEPS, value);
    *steps = n;
    return CALX_OK;
}

static int set_steps(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return read_steps("--steps", value, 1, &a->steps, error);
}

static int set_warm(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    return read_steps("--warm", value, 0, &a->warm, error);
}

static int set_json(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->json = true;
    return CALX_OK;
}

static int set_resume(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->resume = true;
    return CALX_OK;
}

static int set_force(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->force = true;
    return CALX_OK;
}

static int set_quiet(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->quiet = true;
    return CALX_OK;
}

static int set_reference(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->reference = true;
    return CALX_OK;
}

static int set_help(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)value, (void)error;
    a->help = true;
    return CALX_OK;
}

static int set_check(struct calx_arguments *a, const char *value, struct calx_error *error)
{
    (void)error;
    a->check = value;
    return CALX_OK;
}

const struct calx_option calx_option_set = {
    "--set", "path=value", "change an attribute of the case; may be repeated", set_setting};
const struct calx_option calx_option_out = {"--out", "DIR", "folder for the output", set_out};
const struct calx_option calx_option_threads = {
    "--threads", "N", "threads to use (all cores); the result is the same", set_threads};
const struct calx_option calx_option_resume = {
    "--resume", NULL, "go on from the restart point in the output folder", set_resume};
const struct calx_option calx_option_force = {
    "--force", NULL, "run even with a step too long to be stable or to resolve contacts",
    set_force};
const struct calx_option calx_option_quiet = {"--quiet", NULL, "no progress and no summary",
                                              set_quiet};
const struct calx_option calx_option_check = {
    "--check", "FILE.so", "run the conformance suite on that plugin", set_check};
const struct calx_option calx_option_reference = {
    "--reference", NULL, "the reference for people (cases/FORMAT.md) instead", set_reference};
const struct calx_option calx_option_thread_list = {
    "--threads", "N,M,...", "numbers of threads to measure (all cores)", set_thread_list};
const struct calx_option calx_option_steps = {
    "--steps", "N", "steps on the clock (as many as take 2 s)", set_steps};
const struct calx_option calx_option_warm = {"--warm", "N", "steps before the clock starts (100)",
                                             set_warm};
const struct calx_option calx_option_json = {"--json", NULL,
                                             "one JSON object per number of threads", set_json};
static const struct calx_option option_help = {"--help", NULL, "this text", set_help};

/* ---- parsing ---- */

static const struct calx_option *find_option(const struct calx_command *command, const char *name,
                                             size_t length)
{
    for (size_t i = 0; i < command->option_count; ++i)
        if (strlen(command->options[i]->name) == length &&
            strncmp(command->options[i]->name, name, length) == 0)
            return command->options[i];
    bool help = (length == 6 && strncmp(name, "--help", length) == 0) ||
                (length == 2 && strncmp(name, "-h", length) == 0);
    return help ? &option_help : NULL;
}

static int unknown_option(const struct calx_command *command, const char *name,
                          struct calx_error *error)
{
    const char *names[MOST_OPTIONS + 1] = {"--help"};
    size_t n = 1;
    for (size_t i = 0; i < command->option_count && n < MOST_OPTIONS; ++i)
        names[n++] = command->options[i]->name;
    const char *nearest = calx_error_nearest(name, names, n);
    return calx_error_set(error, CALX_ERROR_INPUT,
                          "calx %s has no option '%s'%s%s%s (see calx %s --help)", command->name,
                          name, nearest ? "; did you mean " : "", nearest ? nearest : "",
                          nearest ? "?" : "", command->name);
}

/* Reads the option at argv[*i]; *i moves on by one if its value is the next word. */
static int parse_option(const struct calx_command *command, int argc, char **argv, int *i,
                        struct calx_arguments *a, struct calx_error *error)
{
    const char *word = argv[*i], *equals = strchr(word, '=');
    const struct calx_option *option =
        find_option(command, word, equals ? (size_t)(equals - word) : strlen(word));
    if (!option)
        return unknown_option(command, word, error);
    if (!option->argument) {
        if (equals)
            return calx_error_set(error, CALX_ERROR_INPUT, "%s takes no value", option->name);
        return option->set(a, NULL, error);
    }
    if (equals)
        return option->set(a, equals + 1, error);
    if (*i + 1 >= argc)
        return calx_error_set(error, CALX_ERROR_INPUT, "%s needs a value: %s %s", option->name,
                              option->name, option->argument);
    return option->set(a, argv[++*i], error);
}

static int check_operands(const struct calx_command *command, const struct calx_arguments *a,
                          struct calx_error *error)
{
    if (a->help || (a->operand_count >= command->least && a->operand_count <= command->most))
        return CALX_OK;
    if (a->operand_count < command->least)
        return calx_error_set(error, CALX_ERROR_INPUT, "missing operand; usage: calx %s %s",
                              command->name, command->operands);
    return calx_error_set(error, CALX_ERROR_INPUT,
                          "'%s' is one operand too many; usage: calx %s %s",
                          a->operands[command->most], command->name, command->operands);
}

int calx_options_parse(const struct calx_command *command, int argc, char **argv,
                       struct calx_arguments *a, struct calx_error *error)
{
    *a = (struct calx_arguments){.warm = -1};
    a->operands = calloc((size_t)argc + 1, sizeof *a->operands);
    if (!a->operands)
        return calx_error_set(error, CALX_ERROR_MEMORY, "out of memory");
    bool options = true;
    for (int i = 1; i < argc; ++i) {
        if (options && strcmp(argv[i], "--") == 0)
            options = false;
        else if (options && argv[i][0] == '-' && argv[i][1])
            CALX_TRY(parse_option(command, argc, argv, &i, a, error));
        else
            a->operands[a->operand_count++] = argv[i];
    }
    return check_operands(command, a, error);
}

void calx_options_clear(struct calx_arguments *a)
{
    for (size_t i = 0; i < a->setting_count; ++i)
        free((char *)a->settings[i].path);
    free(a->settings);
    free(a->operands);
    *a = (struct calx_arguments){0};
}

int calx_options_report(const struct calx_error *error)
{
    fprintf(stderr, "calx: error: ");
    if (error->file[0])
        fprintf(stderr, "%s:%d: ", error->file, error->line);
    fprintf(stderr, "%s\n", error->text);
    return calx_error_exit(error->code);
}

/* ---- help ---- */

static void print_option(const struct calx_option *option, FILE *file)
{
    char left[64];
    snprintf(left, sizeof left, "%s %s", option->name, option->argument ? option->argument : "");
    fprintf(file, "  %-20s %s\n", left, option->doc);
}

void calx_options_print_help(const struct calx_command *command, FILE *file)
{
    fprintf(file, "calx %s %s\n\n%s\n\n", command->name, command->operands, command->summary);
    for (size_t i = 0; i < command->option_count; ++i)
        print_option(command->options[i], file);
    print_option(&option_help, file);
    fprintf(file, "\n%s", command->details);
}
