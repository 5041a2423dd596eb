/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Numbers with units, converted by UDUNITS-2. Input: text of an attribute. Output: doubles in the
 * unit the caller names. Method: numbers are split from units by hand, the unit text goes to
 * UDUNITS-2, which gives an affine conversion. On top of it an angle is not a pure number here: a
 * unit with radians converts only to one with radians, because "10 rpm" is no frequency in hertz.
 */
#include "io/quantity.h"

#include <ctype.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <udunits2.h>

#define LONGEST_UNIT 96

/* The unit system is read once (10 ms) and never changes after that. UDUNITS-2 parses with global
 * variables, hence the lock. */
static pthread_mutex_t units_lock = PTHREAD_MUTEX_INITIALIZER;
static ut_system *units;
static locale_t plain_locale; /* numbers have a point in every language */

/* A name people write that the database lacks. */
static int add_unit(const char *name, const char *definition)
{
    ut_unit *known = ut_parse(units, name, UT_UTF8);
    if (known) {
        ut_free(known);
        return CALX_OK;
    }
    ut_unit *unit = ut_parse(units, definition, UT_UTF8);
    ut_status status = unit ? ut_map_name_to_unit(name, UT_ASCII, unit) : UT_UNKNOWN;
    ut_free(unit);
    return status == UT_SUCCESS ? CALX_OK : CALX_ERROR_IO;
}

static int load_units(struct calx_error *e)
{
    if (units)
        return CALX_OK;
    ut_set_error_message_handler(ut_ignore);
    plain_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    units = ut_read_xml(NULL);
    if (!units || !plain_locale)
        return calx_error_set(e, CALX_ERROR_IO,
                              "the database of units of UDUNITS-2 cannot be read");
    return add_unit("deg", "degree") || add_unit("rev", "revolution")
               ? calx_error_set(e, CALX_ERROR_IO,
                                "the database of units of UDUNITS-2 lacks degree or revolution")
               : CALX_OK;
}

/* ---- conversion
 * ---------------------------------------------------------------------------------------- */

struct conversion {
    double scale, offset;
};

static bool has_angle(const ut_unit *unit)
{
    char definition[512];
    int length = ut_format(unit, definition, sizeof definition, UT_ASCII | UT_DEFINITION);
    return length > 0 && (size_t)length < sizeof definition && strstr(definition, "rad") != NULL;
}

static int convert_units(ut_unit *from, ut_unit *to, const char *from_text, const char *to_text,
                         struct conversion *out, struct calx_error *e)
{
    if (!ut_are_convertible(from, to) || has_angle(from) != has_angle(to))
        return strcmp(to_text, "1") == 0
                   ? calx_error_set(e, CALX_ERROR_INPUT,
                                    "unit '%s' where a number without unit is expected", from_text)
                   : calx_error_set(e, CALX_ERROR_INPUT,
                                    "unit '%s' where one like '%s' is expected", from_text,
                                    to_text);
    cv_converter *converter = ut_get_converter(from, to);
    if (!converter)
        return calx_error_set(e, CALX_ERROR_MEMORY, "no memory to convert units");
    out->offset = cv_convert_double(converter, 0.0);
    out->scale = cv_convert_double(converter, 1.0) - out->offset;
    cv_free(converter);
    return CALX_OK;
}

static int find_conversion_locked(const char *from, const char *unit, struct conversion *out,
                                  struct calx_error *e)
{
    CALX_TRY(load_units(e));
    ut_unit *from_unit = ut_parse(units, from, UT_UTF8), *to_unit = ut_parse(units, unit, UT_UTF8);
    int code;
    if (!from_unit || !to_unit)
        code = calx_error_set(e, CALX_ERROR_INPUT, "unknown unit '%s', expected one like '%s'",
                              from_unit ? unit : from, unit);
    else
        code = convert_units(from_unit, to_unit, from, unit, out, e);
    ut_free(from_unit);
    ut_free(to_unit);
    return code;
}

static int find_conversion(const char *from, const char *unit, struct conversion *out,
                           struct calx_error *e)
{
    if (strcmp(from, unit) == 0 && *from != '\0') {
        *out = (struct conversion){1.0, 0.0};
        return calx_quantity_check_unit(unit, e);
    }
    pthread_mutex_lock(&units_lock);
    int code = find_conversion_locked(from, unit, out, e);
    pthread_mutex_unlock(&units_lock);
    return code;
}

int calx_quantity_conversion(const char *from, const char *unit, double *scale, double *offset,
                             struct calx_error *e)
{
    struct conversion conversion;
    CALX_TRY(find_conversion(from, unit, &conversion, e));
    *scale = conversion.scale;
    *offset = conversion.offset;
    return CALX_OK;
}

int calx_quantity_check_unit(const char *unit, struct calx_error *e)
{
    pthread_mutex_lock(&units_lock);
    int code = load_units(e);
    ut_unit *known = code ? NULL : ut_parse(units, unit, UT_UTF8);
    pthread_mutex_unlock(&units_lock);
    if (!code && !known)
        code = calx_error_set(e, CALX_ERROR_INPUT, "unknown unit '%s'", unit);
    ut_free(known);
    return code;
}

/* ---- text
 * ---------------------------------------------------------------------------------------------- */

/* What is being read. pending: numbers at the end of the list that wait for a unit. */
struct scan {
    const char *text, *at, *unit;
    bool difference;
    double *values;
    size_t max, count, pending;
    char word[LONGEST_UNIT]; /* the unit text gathered so far */
    size_t units_seen;
    struct calx_error *error;
};

static int complain(struct scan *s, const char *what)
{
    return calx_error_set(s->error, CALX_ERROR_INPUT,
                          "'%.80s' %s, expected a number with a unit like '%s'", s->text, what,
                          s->unit);
}

static bool ends_word(char c)
{
    return c == '\0' || isspace((unsigned char)c);
}

/* Whether a number starts at p, and where it ends. Hexadecimal and named numbers (nan, inf) are not
 * numbers here. */
static bool scan_number(const char *p, double *value, const char **end)
{
    const char *digits = p + (*p == '+' || *p == '-');
    if (!isdigit((unsigned char)digits[*digits == '.']) ||
        (digits[0] == '0' && (digits[1] | 32) == 'x'))
        return false;
    char *stop;
    *value = strtod_l(p, &stop, plain_locale);
    if (!ends_word(*stop) && !isalpha((unsigned char)*stop) && *stop != '%' &&
        (unsigned char)*stop < 0x80)
        return false;
    *end = stop;
    return true;
}

/* Divides where the scale is one over a whole number, so that "3.8 mm" has the bits of "0.0038". */
static double convert(double value, struct conversion conversion, bool difference)
{
    double inverse = 1.0 / conversion.scale;
    double scaled =
        inverse > 1.0 && inverse == rint(inverse) ? value / inverse : value * conversion.scale;
    return difference ? scaled : scaled + conversion.offset;
}

/* A unit holds for the numbers before it that have none. */
static int apply_unit(struct scan *s)
{
    struct conversion conversion = {1.0, 0.0};
    if (*s->word) {
        if (!s->pending)
            return complain(s, "has a unit without a number");
        CALX_TRY(find_conversion(s->word, s->unit, &conversion, s->error));
        s->units_seen++;
    } else if (s->units_seen && s->pending) {
        return complain(s, "has a number without a unit after one with a unit");
    }
    for (size_t k = s->count - s->pending; k < s->count && k < s->max; k++) {
        s->values[k] = convert(s->values[k], conversion, s->difference);
        if (!isfinite(s->values[k]))
            return complain(s, "is not finite");
    }
    s->pending = 0;
    s->word[0] = '\0';
    return CALX_OK;
}

static int add_number(struct scan *s, double value)
{
    if (*s->word)
        CALX_TRY(apply_unit(s));
    if (!isfinite(value))
        return complain(s, "is not finite");
    if (s->count < s->max)
        s->values[s->count] = value;
    s->count++;
    s->pending++;
    return CALX_OK;
}

static int add_unit_word(struct scan *s)
{
    static const char *const not_finite[] = {"nan", "inf", "infinity"};
    const char *start = s->at;
    while (!ends_word(*s->at))
        s->at++;
    size_t used = strlen(s->word), length = (size_t)(s->at - start);
    const char *bare = start + (*start == '-' || *start == '+');
    for (size_t k = 0; k < sizeof not_finite / sizeof *not_finite; k++)
        if (strlen(not_finite[k]) == (size_t)(s->at - bare) &&
            strncasecmp(bare, not_finite[k], strlen(not_finite[k])) == 0)
            return complain(s, "is not finite");
    if (used + length + 2 > sizeof s->word)
        return complain(s, "has too long a unit");
    if (used)
        s->word[used++] = ' ';
    memcpy(s->word + used, start, length);
    s->word[used + length] = '\0';
    return CALX_OK;
}

static int scan_list(struct scan *s)
{
    pthread_mutex_lock(&units_lock);
    int code = load_units(s->error); /* for the locale */
    pthread_mutex_unlock(&units_lock);
    CALX_TRY(code);
    for (;;) {
        double value;
        while (isspace((unsigned char)*s->at))
            s->at++;
        if (*s->at == '\0')
            break;
        if (scan_number(s->at, &value, &s->at))
            CALX_TRY(add_number(s, value));
        else
            CALX_TRY(add_unit_word(s));
    }
    if (!s->count)
        return complain(s, "holds no number");
    return apply_unit(s);
}

static int parse_one(const char *text, const char *unit, bool difference, double *value,
                     struct calx_error *e)
{
    struct scan s = {.text = text,
                     .at = text,
                     .unit = unit,
                     .difference = difference,
                     .values = value,
                     .max = 1,
                     .error = e};
    CALX_TRY(scan_list(&s));
    return s.count == 1 ? CALX_OK : complain(&s, "holds more than one number");
}

int calx_quantity_parse(const char *text, const char *unit, double *value, struct calx_error *e)
{
    return parse_one(text, unit, false, value, e);
}

int calx_quantity_parse_difference(const char *text, const char *unit, double *value,
                                   struct calx_error *e)
{
    return parse_one(text, unit, true, value, e);
}

int calx_quantity_parse_list(const char *text, const char *unit, double *values, size_t max,
                             size_t *count, struct calx_error *e)
{
    struct scan s = {
        .text = text, .at = text, .unit = unit, .values = values, .max = max, .error = e};
    CALX_TRY(scan_list(&s));
    *count = s.count;
    return s.count <= max ? CALX_OK : complain(&s, "holds too many numbers");
}
