/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Radii of bodies as a case gives them: one, a distribution, or classes with their shares of the
 * mass or of the number.
 */
#include "io/case_bodies.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/quantity.h"

static bool are_radii(struct calx_reader *r, const xmlNode *node, const double *v, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (!(v[k] >= CALX_LEAST_RADIUS && v[k] <= CALX_LARGEST_RADIUS)) {
            calx_case_fail(r, node, "radius",
                           "%g m is out of range, expected at least %g and at most %g", v[k],
                           CALX_LEAST_RADIUS, CALX_LARGEST_RADIUS);
            return false;
        }
    return true;
}

/* A diameter with its unit, which may be further words, and the share that follows. Returns the
 * word after them. */
static const char **read_class(struct calx_reader *r, const xmlNode *node, const char **word,
                               struct calx_radii *radii)
{
    char length[96];
    size_t used = (size_t)snprintf(length, sizeof length, "%.60s", *word++);
    struct calx_error e;
    double v[2];
    while (*word && !isdigit((unsigned char)**word) && **word != '.' && used < sizeof length)
        used += (size_t)snprintf(length + used, sizeof length - used, " %.20s", *word++);
    if (!*word || radii->sizes.count == CALX_MOST_CLASSES) {
        calx_case_fail(r, node, "radius", "expected pairs of a diameter and its share, at most %d",
                       CALX_MOST_CLASSES);
        return NULL;
    }
    if (calx_quantity_parse(length, "m", &v[0], &e) || calx_quantity_parse(*word, "1", &v[1], &e)) {
        calx_case_fail_with(r, node, "radius", &e);
        return NULL;
    }
    if (!(v[1] > 0))
        calx_case_fail(r, node, "radius", "share %g, expected greater than 0", v[1]);
    if (!(v[1] > 0) || !are_radii(r, node, v, 1))
        return NULL;
    radii->list[radii->sizes.count] = v[0] / 2;
    radii->weight[radii->sizes.count++] = v[1];
    return word + 1;
}

static bool read_shares(struct calx_reader *r, const xmlNode *node, const char *text,
                        struct calx_radii *radii)
{
    const char *words[4 * CALX_MOST_CLASSES + 1] = {NULL}, **word = words;
    char *copy;
    size_t count = calx_case_split(text, "", &copy, words, 4 * CALX_MOST_CLASSES);
    while (word && *word)
        word = read_class(r, node, word, radii);
    if (!count)
        calx_case_fail(r, node, "radius", "expected pairs of a diameter and its share");
    free(copy);
    return word && count;
}

/* The numbers after the word of a distribution: least to most of them. */
static bool read_numbers(struct calx_reader *r, const xmlNode *node, const char *text, size_t least,
                         size_t most, double *v)
{
    struct calx_error e;
    size_t count;
    if (calx_quantity_parse_list(text, "m", v, 4, &count, &e)) {
        calx_case_fail_with(r, node, "radius", &e);
        return false;
    }
    if (count != least && count != most) {
        calx_case_fail(r, node, "radius", "'%.80s' has %zu numbers, expected %zu%s", text, count,
                       least, most > least ? " or 4" : "");
        return false;
    }
    if (!are_radii(r, node, v, count))
        return false;
    bool ends_in_range = count == 4 || least == most;
    if (ends_in_range && v[count - 2] > v[count - 1]) {
        calx_case_fail(r, node, "radius", "'%.80s': the least is above the largest", text);
        return false;
    }
    return true;
}

static bool read_distribution(struct calx_reader *r, const xmlNode *node, const char *text,
                              struct calx_radii *radii)
{
    static const struct {
        const char *word;
        enum calx_sizes_kind kind;
        size_t least, most;
    } known[] = {{"uniform", CALX_SIZES_UNIFORM, 2, 2},
                 {"normal", CALX_SIZES_NORMAL, 2, 4},
                 {"lognormal", CALX_SIZES_LOGNORMAL, 2, 4}};
    const char *names[] = {"uniform", "normal", "lognormal", "masses", "numbers"};
    double v[4] = {0};
    size_t length = strcspn(text, " \t");
    char word[24];
    snprintf(word, sizeof word, "%.*s", (int)(length < 20 ? length : 20), text);
    if (strcmp(word, "masses") == 0 || strcmp(word, "numbers") == 0) {
        radii->sizes.kind = *word == 'm' ? CALX_SIZES_MASSES : CALX_SIZES_NUMBERS;
        return read_shares(r, node, text + length, radii);
    }
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(word, known[k].word) == 0) {
            bool good = read_numbers(r, node, text + length, known[k].least, known[k].most, v);
            radii->sizes = (struct calx_sizes){
                .kind = known[k].kind, .a = v[0], .b = v[1], .min = v[2], .max = v[3]};
            return good;
        }
    calx_case_fail_name(r, node, "radius", "distribution", word, names, 5);
    return false;
}

bool calx_case_read_radii(struct calx_reader *r, const xmlNode *node, struct calx_radii *radii)
{
    const xmlNode *bearer = calx_case_bearer(node, "radius");
    const char *text = bearer ? calx_case_given(bearer, "radius") : "";
    bool good;
    text += strspn(text, " \t\r\n");
    if (!bearer || !isalpha((unsigned char)*text)) {
        radii->sizes =
            (struct calx_sizes){.kind = CALX_SIZES_FIXED, .a = calx_case_radius(r, node)};
        good = !isnan(radii->sizes.a);
    } else {
        good = read_distribution(r, bearer, text, radii);
    }
    radii->sizes.list = radii->list;
    radii->sizes.weight = radii->weight;
    return good;
}
