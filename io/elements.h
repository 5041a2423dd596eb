/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The elements and attributes of the case file as tables: the reader, its messages, the RELAX NG
 * grammar and cases/FORMAT.md all come from them. Parameters of plugins come from the plugins' own
 * tables.
 */
#ifndef CALX_ELEMENTS_H
#define CALX_ELEMENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* How the text of an attribute is read. */
enum calx_form {
    CALX_FORM_TEXT,     /* any text */
    CALX_FORM_NAME,     /* a name that others refer to: letters, digits, - _ . */
    CALX_FORM_FILE,     /* path of a file, relative to the case file */
    CALX_FORM_WORD,     /* one of `choices` */
    CALX_FORM_WORDS,    /* some of `choices`, separated by blanks */
    CALX_FORM_SWITCH,   /* yes or no */
    CALX_FORM_WHOLE,    /* a whole number, at least 0 */
    CALX_FORM_WHOLES,   /* two or three whole numbers */
    CALX_FORM_QUANTITY, /* a number with a unit */
    CALX_FORM_AUTO,     /* auto, or a number with a unit */
    CALX_FORM_VECTOR,   /* as many numbers as dimensions, with a unit */
    CALX_FORM_LIST,     /* numbers with a unit */
    CALX_FORM_VARIES, /* a number with a unit or an expression of `choices` (letters of t, x, y, z)
                       */
    CALX_FORM_VARYING_VECTOR, /* as many of them as dimensions */
    CALX_FORM_RANDOM_VECTOR,  /* a vector, or "random" and a number with a unit */
    CALX_FORM_SIZES,          /* a radius, or a distribution of radii */
    CALX_FORM_CONDITION,      /* a quantity of calx, < or >, a number with its unit; or a time */
    CALX_FORM_RESULT          /* "yes", or an expression of t with the unit of what is expected */
};

enum calx_attribute_flags {
    CALX_ATTRIBUTE_REQUIRED = 1,
    CALX_ATTRIBUTE_OPEN_MIN = 2,   /* greater than min, not equal */
    CALX_ATTRIBUTE_DIFFERENCE = 4, /* a difference: 5 degC is 5 K */
    CALX_ATTRIBUTE_EXISTS = 8      /* a file that must exist */
};

struct calx_attribute {
    const char *name; /* "" for the text inside the element */
    enum calx_form form;
    const char *unit;    /* UDUNITS-2 text, or NULL */
    const char *choices; /* "a|b|c", or the variables of an expression, or NULL */
    const char *initial; /* what holds if it is not given, or NULL */
    double min, max;     /* of numbers, in `unit` */
    uint32_t flags;      /* enum calx_attribute_flags */
    const char *doc;
};

/* What plugin parameters an element takes besides its own attributes. */
enum calx_parameters {
    CALX_TAKES_NONE,
    CALX_TAKES_RUN_AND_PAIR,
    CALX_TAKES_PAIR,
    CALX_TAKES_MATERIAL
};

struct calx_child {
    const struct calx_element *element;
    char occurs; /* '?' at most once, '*' any number, '+' at least once */
};

struct calx_element {
    const char *name;
    const char
        *id; /* unique: differs from name where an element means something else inside another */
    const char *doc;
    size_t attribute_count;
    const struct calx_attribute *attributes;
    size_t child_count;
    const struct calx_child *children;
    enum calx_parameters parameters;
};

/* The element <case>, from which all others are reached. */
const struct calx_element *calx_elements_root(void);

/* The row of that attribute, or NULL. */
const struct calx_attribute *calx_element_attribute(const struct calx_element *, const char *name);

/* The element of that name inside another, or NULL. */
const struct calx_child *calx_element_child(const struct calx_element *, const char *name);

/* Stores every element once, parents before children, at most max; returns how many are stored. */
size_t calx_elements_list(const struct calx_element **list, size_t max);

#endif
