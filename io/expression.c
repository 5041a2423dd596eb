/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Numbers that may vary. Input: text of an attribute. Output: struct calx_function, whose context
 * holds a muParser handle. Method: what reads as a quantity is a constant; anything else goes to
 * muParser (https://beltoforion.de/en/muparser) with t, x, y, z as variables and the entries of
 * `where` as constants; the result is converted from the unit in brackets.
 */
#include "io/expression.h"

#include <ctype.h>
#include <math.h>
#include <muParserDLL.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/quantity.h"

/* muParser refuses more than 5000 characters with a text about an internal table. */
#define LONGEST_EXPRESSION 4000

/* What a compiled expression needs; the host calls it from one thread. */
struct compiled {
    muParserHandle_t parser;
    double t, x[3];
    double scale, offset;
};

static void compiled_free(void *what)
{
    struct compiled *c = what;
    mupRelease(c->parser);
    free(c);
}

/* The context is const for core; the variables inside are muParser's way to pass arguments. */
static double compiled_eval(const void *context, double t, const double x[3])
{
    struct compiled *c = (struct compiled *)(uintptr_t)context;
    c->t = t;
    if (x)
        memcpy(c->x, x, sizeof c->x);
    return mupEval(c->parser) * c->scale + c->offset;
}

/* ---- compiling
 * ----------------------------------------------------------------------------------------- */

static int complain(muParserHandle_t parser, const char *text, const char *variables,
                    struct calx_error *e)
{
    char position[32] = "", message[256];
    int at = mupGetErrorPos(parser);
    snprintf(message, sizeof message, "%s", mupGetErrorMsg(parser));
    if (strstr(message, "nternal error"))
        snprintf(message, sizeof message, "something is missing");
    if (at >= 0 && (size_t)at <= strlen(text))
        snprintf(position, sizeof position, " at character %d", at + 1);
    mupErrorReset(parser);
    return calx_error_set(
        e, CALX_ERROR_INPUT,
        "'%.200s' is neither a number with a unit nor an expression%s: %s (variables here: %s)",
        text, position, message, *variables ? variables : "none");
}

static void define_variables(struct compiled *c, const char *variables)
{
    struct {
        const char *name;
        double *at;
    } known[] = {{"t", &c->t}, {"x", &c->x[0]}, {"y", &c->x[1]}, {"z", &c->x[2]}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strchr(variables, *known[k].name))
            mupDefineVar(c->parser, known[k].name, known[k].at);
}

/* Evaluates once, which makes muParser compile. One result is wanted, not a list. */
static int evaluate(muParserHandle_t parser, const char *text, const char *variables, double *value,
                    struct calx_error *e)
{
    int results = 0;
    if (strlen(text) > LONGEST_EXPRESSION)
        return calx_error_set(e, CALX_ERROR_INPUT, "an expression has at most %d characters",
                              LONGEST_EXPRESSION);
    mupSetExpr(parser, text);
    const double *values = mupError(parser) ? NULL : mupEvalMulti(parser, &results);
    if (mupError(parser))
        return complain(parser, text, variables, e);
    if (results != 1)
        return calx_error_set(e, CALX_ERROR_INPUT,
                              "'%.200s' gives %d numbers where one is expected", text, results);
    *value = values[0];
    return CALX_OK;
}

static const char *trim(char *text)
{
    while (isspace((unsigned char)*text))
        text++;
    size_t length = strlen(text);
    while (length && isspace((unsigned char)text[length - 1]))
        text[--length] = '\0';
    return text;
}

/* One "name = expression" of the list; later ones may use it. */
static int define_constant(muParserHandle_t parser, char *entry, struct calx_error *e)
{
    char *equals = strchr(entry, '=');
    double value;
    if (!equals)
        return calx_error_set(e, CALX_ERROR_INPUT, "where: '%.80s', expected 'name = expression'",
                              entry);
    *equals = '\0';
    const char *name = trim(entry), *text = trim(equals + 1);
    CALX_TRY(evaluate(parser, text, "", &value, e));
    if (!isfinite(value))
        return calx_error_set(e, CALX_ERROR_INPUT, "where: %.80s is not finite", name);
    mupDefineConst(parser, name, value);
    return mupError(parser) ? complain(parser, name, "", e) : CALX_OK;
}

static int define_constants(muParserHandle_t parser, const char *where, struct calx_error *e)
{
    char *copy = strdup(where), *rest = copy;
    int code = copy ? CALX_OK : calx_error_set(e, CALX_ERROR_MEMORY, "no memory for constants");
    for (char *entry; !code && (entry = strsep(&rest, ";"));)
        if (*trim(entry))
            code = define_constant(parser, entry, e);
    free(copy);
    return code;
}

static struct compiled *compiled_create(void)
{
    struct compiled *c = calloc(1, sizeof *c);
    if (!c)
        return NULL;
    c->scale = 1.0;
    c->parser = mupCreate(muBASETYPE_FLOAT);
    if (!c->parser) {
        free(c);
        return NULL;
    }
    mupDefineConst(c->parser, "_pi", M_PI); /* muParser's own has 13 digits */
    mupDefineConst(c->parser, "_e", M_E);
    return c;
}

/* Removes "[unit]" from the end of text. */
static int split_unit(char *text, const struct calx_expression_options *options, double *scale,
                      double *offset, struct calx_error *e)
{
    size_t length = strlen(text);
    char *open = strrchr(text, '[');
    if (!open || text[length - 1] != ']')
        return CALX_OK;
    text[length - 1] = '\0';
    *open = '\0';
    CALX_TRY(calx_quantity_conversion(open + 1, options->unit, scale, offset, e));
    if (options->difference)
        *offset = 0.0;
    return CALX_OK;
}

static int compile(struct compiled *c, char *text, const struct calx_expression_options *options,
                   double *value, struct calx_error *e)
{
    const char *variables = options->variables ? options->variables : "";
    CALX_TRY(split_unit(text, options, &c->scale, &c->offset, e));
    if (options->where)
        CALX_TRY(define_constants(c->parser, options->where, e));
    define_variables(c, variables);
    CALX_TRY(evaluate(c->parser, trim(text), variables, value, e));
    *value = *value * c->scale + c->offset;
    return CALX_OK;
}

/* Plain values where no variable is used, else the compiled expression attached to the scene. */
static int finish(struct compiled *c, double value, const char *text, struct calx_scene *scene,
                  struct calx_function *f, struct calx_error *e)
{
    if (mupGetExprVarNum(c->parser) == 0) {
        compiled_free(c);
        *f = (struct calx_function){.value = value};
        return isfinite(value)
                   ? CALX_OK
                   : calx_error_set(e, CALX_ERROR_INPUT, "'%.200s' is not finite", text);
    }
    if (calx_scene_attach(scene, c, compiled_free)) {
        compiled_free(c);
        return calx_error_set(e, CALX_ERROR_MEMORY, "no memory for an expression");
    }
    *f = (struct calx_function){.eval = compiled_eval, .context = c};
    return CALX_OK;
}

static int read_expression(const char *text, const struct calx_expression_options *options,
                           struct calx_scene *scene, struct calx_function *f, struct calx_error *e)
{
    struct compiled *c = compiled_create();
    char *copy = strdup(text);
    double value = 0;
    int code;
    if (!c || !copy)
        code = calx_error_set(e, CALX_ERROR_MEMORY, "no memory for an expression");
    else
        code = compile(c, copy, options, &value, e);
    free(copy);
    if (!code)
        return finish(c, value, text, scene, f, e);
    if (c)
        compiled_free(c);
    return code;
}

/* "2 kg" and "2 mmm" are quantities with a mistake, "2*t" and "t" are not quantities. */
static bool resembles_quantity(const char *text)
{
    const char *digits = text + strspn(text, " \t\n\r+-.");
    const char *unit = text + strspn(text, " \t\n\r+-.0123456789eE");
    return isdigit((unsigned char)*digits) && isalpha((unsigned char)*unit) &&
           !strpbrk(unit, "+*(^?<>=,[");
}

int calx_expression_read(const char *text, const struct calx_expression_options *options,
                         struct calx_scene *scene, struct calx_function *f, struct calx_error *e)
{
    struct calx_error as_quantity;
    double value;
    int code = options->difference
                   ? calx_quantity_parse_difference(text, options->unit, &value, &as_quantity)
                   : calx_quantity_parse(text, options->unit, &value, &as_quantity);
    if (!code) {
        *f = (struct calx_function){.value = value};
        return CALX_OK;
    }
    code = read_expression(text, options, scene, f, e);
    if (code == CALX_ERROR_INPUT && e && resembles_quantity(text))
        *e = as_quantity;
    return code;
}

/* ---- lists
 * --------------------------------------------------------------------------------------------- */

/* Ends the item that starts at text and returns the next one, or NULL. Items end at semicolons, or,
 * if there are none, at blanks outside of parentheses. */
static char *split_item(char *text, bool semicolons)
{
    int depth = 0;
    for (; *text; text++) {
        depth += (*text == '(') - (*text == ')');
        if (semicolons ? *text == ';' : depth <= 0 && isspace((unsigned char)*text)) {
            *text = '\0';
            return text + 1;
        }
    }
    return NULL;
}

/* The item with the unit of the whole list put behind it. */
static int read_item(const char *item, const char *unit,
                     const struct calx_expression_options *options, struct calx_scene *scene,
                     struct calx_function *f, struct calx_error *e)
{
    size_t size = strlen(item) + strlen(unit) + 1;
    char *text = malloc(size);
    if (!text)
        return calx_error_set(e, CALX_ERROR_MEMORY, "no memory for an expression");
    snprintf(text, size, "%s%s", item, unit);
    int code = *unit ? read_expression(text, options, scene, f, e)
                     : calx_expression_read(text, options, scene, f, e);
    free(text);
    return code;
}

static int read_items(char *text, const struct calx_expression_options *options,
                      struct calx_scene *scene, struct calx_function f[3], size_t *count,
                      struct calx_error *e)
{
    char unit[96] = "", *bracket = strrchr(text, '[');
    bool semicolons = strchr(text, ';') != NULL;
    if (bracket && strchr(bracket, ']')) {
        snprintf(unit, sizeof unit, "%s", trim(bracket));
        *bracket = '\0';
    }
    *count = 0;
    for (char *item = text, *next; item; item = next) {
        next = split_item(item, semicolons);
        const char *trimmed = trim(item);
        if (!*trimmed)
            continue;
        if (*count == 3)
            return calx_error_set(e, CALX_ERROR_INPUT, "more than three components");
        CALX_TRY(read_item(trimmed, unit, options, scene, &f[*count], e));
        ++*count;
    }
    return *count ? CALX_OK : calx_error_set(e, CALX_ERROR_INPUT, "no number");
}

static void append_hint(struct calx_error *e)
{
    size_t used = strlen(e->text);
    snprintf(e->text + used, sizeof e->text - used,
             "; components are expressions without blanks, or have semicolons between them");
}

int calx_expression_read_list(const char *text, const struct calx_expression_options *options,
                              struct calx_scene *scene, struct calx_function f[3], size_t *count,
                              struct calx_error *e)
{
    double values[3];
    struct calx_error as_quantity;
    int code = calx_quantity_parse_list(text, options->unit, values, 3, count, &as_quantity);
    for (size_t k = 0; !code && k < *count; k++)
        f[k] = (struct calx_function){.value = values[k]};
    if (!code)
        return CALX_OK;
    char *copy = strdup(text);
    if (!copy)
        return calx_error_set(e, CALX_ERROR_MEMORY, "no memory for an expression");
    code = read_items(copy, options, scene, f, count, e);
    free(copy);
    if (code != CALX_ERROR_INPUT || !e)
        return code;
    if (resembles_quantity(text))
        *e = as_quantity;
    else
        append_hint(e);
    return code;
}
