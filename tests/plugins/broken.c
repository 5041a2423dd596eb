/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A descriptor that is right for FAULT NONE and that the loader must refuse for each other, one
 * rule each. For tests only.
 */
#include <math.h>
#include <stddef.h>

#include "core/plugin.h"

enum {
    NONE,
    OTHER,
    SYMBOL,
    MAGIC,
    ABI,
    SIZE,
    KIND,
    NAME,
    SUMMARY,
    LAW,
    FORCE,
    RESPONSE,
    CONDITION,
    PROVIDES,
    HISTORY,
    TABLE,
    ROW_NAME,
    ROW_TWICE,
    ROW_TEXTS,
    ROW_SCOPE,
    ROW_FLAGS,
    ROW_WORDS,
    ROW_CHOICES,
    ROW_NAN,
    ROW_CROSSED,
    ROW_RANGE,
    ROW_DEFAULT,
    ROW_ALIGNED,
    ROW_OUTSIDE,
    ROW_OVERLAPS,
    UNDEFINED
};

struct broken {
    double a, b;
};

static const struct calx_parameter parameters[] = {
    {.name = "a",
     .symbol = "a",
     .unit = "1",
     .doc = "A.",
     .max = 1,
     .offset = offsetof(struct broken, a)},
    {.name = FAULT == ROW_NAME    ? "Bad Name"
             : FAULT == ROW_TWICE ? "a"
                                  : "b",
     .symbol = "b",
     .unit = FAULT == ROW_TEXTS ? NULL : "1",
     .doc = "B.",
     .initial = FAULT == ROW_DEFAULT ? 3 : 0,
     .min = FAULT == ROW_NAN       ? NAN
            : FAULT == ROW_CROSSED ? 2
                                   : 0,
     .max = 1,
     .flags = FAULT == ROW_FLAGS     ? CALX_REQUIRED | CALX_OPTIONAL
              : FAULT == ROW_WORDS   ? CALX_SWITCH | CALX_CHOICE
              : FAULT == ROW_CHOICES ? CALX_CHOICE
              : FAULT == ROW_RANGE   ? CALX_CHOICE
                                     : 0,
     .choices = FAULT == ROW_RANGE   ? "x|y|z"
                : FAULT == ROW_WORDS ? "x|y"
                                     : NULL,
     .scope = FAULT == ROW_SCOPE ? 9 : CALX_RUN,
     .offset = FAULT == ROW_ALIGNED    ? 9
               : FAULT == ROW_OUTSIDE  ? sizeof(struct broken)
               : FAULT == ROW_OVERLAPS ? 0
                                       : offsetof(struct broken, b)},
};

#if FAULT == 30 /* UNDEFINED: a function that exists nowhere */
void calx_test_missing_function(void);
#define CALL_MISSING() calx_test_missing_function()
#else
#define CALL_MISSING() (void)0
#endif

static void force(const void *params, const struct calx_contacts *b)
{
    (void)params, (void)b;
    CALL_MISSING();
}

static void response(const void *params, const struct calx_contacts *b,
                     const struct calx_response *r)
{
    (void)params, (void)b, (void)r;
}

static const struct calx_contact_law law = {.provides = FAULT == PROVIDES ? 0 : CALX_NORMAL,
                                            .demand = {.history_scalars = FAULT == HISTORY},
                                            .force = FAULT == FORCE ? NULL : force,
                                            .response = FAULT == RESPONSE ? NULL : response,
                                            .nonsmooth = FAULT == CONDITION};

#if FAULT == 2 /* SYMBOL: not exported */
#define VISIBILITY "hidden"
#else
#define VISIBILITY "default"
#endif

__attribute__((visibility(VISIBILITY))) extern const struct calx_plugin calx_plugin;

const struct calx_plugin calx_plugin = {.magic = FAULT == MAGIC ? 0x12345678u : CALX_PLUGIN_MAGIC,
                                        .abi = FAULT == ABI ? 7 : CALX_PLUGIN_ABI,
                                        .size = FAULT == SIZE ? 40 : sizeof(struct calx_plugin),
                                        .kind = FAULT == KIND ? 77 : CALX_CONTACT,
                                        .name = FAULT == NAME    ? "Bad Name"
                                                : FAULT == OTHER ? "other"
                                                                 : "broken",
                                        .summary = FAULT == SUMMARY ? "" : "for tests",
                                        .reference = "none",
                                        .equation = "0",
                                        .parameter_count = 2,
                                        .parameters = FAULT == TABLE ? NULL : parameters,
                                        .params_size = sizeof(struct broken),
                                        .law = FAULT == LAW ? NULL : &law};
