/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The shape of a bed, without bodies of rigid groups: slopes of a 2D heap's free surface, and its height.
 * Input: a frame. Output: degrees, metres.
 * Method: the surface is the highest point of the grains in columns of one mean diameter. From the
 * highest column outwards to the foot (the first column that holds no second layer: surface below
 * one and a half mean diameters above the lowest point), a straight line is fitted by least
 * squares; grains that rolled away do not count.
 */
#include "core/heap.h"

#include <math.h>
#include <stdlib.h>

struct surface {
    size_t columns, top; /* top: the highest column */
    double *height;      /* -INFINITY where empty */
    double width, base;
};

static bool make_surface(const struct calx_frame *f, struct surface *s)
{
    const double most = 1e6; /* columns: a grain that flew away must not cost the memory */
    double low = INFINITY, high = -INFINITY, sum = 0;
    double n = 0;
    *s = (struct surface){.base = INFINITY};
    for (size_t i = 0; i < f->n; ++i) {
        if (!calx_frame_is_grain(f, i))
            continue;
        n += 1;
        low = fmin(low, f->position[i][0]);
        high = fmax(high, f->position[i][0]);
        s->base = fmin(s->base, f->position[i][1] - f->radius[i]);
        sum += f->radius[i];
    }
    s->width = 2 * sum / n;
    if (n == 0 || !((high - low) / s->width < most))
        return false;
    s->columns = (size_t)((high - low) / s->width) + 1;
    s->height = malloc(s->columns * sizeof *s->height);
    for (size_t c = 0; s->height && c < s->columns; ++c)
        s->height[c] = -INFINITY;
    for (size_t i = 0; s->height && i < f->n; ++i) {
        if (!calx_frame_is_grain(f, i))
            continue;
        size_t c = (size_t)((f->position[i][0] - low) / s->width);
        s->height[c] = fmax(s->height[c], f->position[i][1] + f->radius[i]);
        if (s->height[c] > s->height[s->top])
            s->top = c;
    }
    return s->height != NULL;
}

/* Least squares of height against the distance from the top, in columns. */
static double fit(const struct surface *s, int side)
{
    const double foot = s->base + 1.5 * s->width;
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (size_t c = s->top; c < s->columns && s->height[c] > foot;
         c += (size_t)side) { /* below 0 wraps: ends */
        double d = n * s->width;
        x += d;
        y += s->height[c];
        xx += d * d;
        xy += d * s->height[c];
        n += 1;
    }
    return n < 2 ? NAN : -atan((n * xy - x * y) / (n * xx - x * x)) * 180 / M_PI;
}

double calx_heap_slope(const struct calx_frame *f, int side)
{
    struct surface s;
    double slope = NAN;
    if (f->dimension == 2 && make_surface(f, &s)) {
        slope = fit(&s, side);
        free(s.height);
    }
    return slope;
}

double calx_heap_height(const struct calx_frame *f, const double up[3])
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < f->n; ++i) {
        if (!calx_frame_is_grain(f, i))
            continue;
        double h =
            f->position[i][0] * up[0] + f->position[i][1] * up[1] + f->position[i][2] * up[2];
        low = fmin(low, h - f->radius[i]);
        high = fmax(high, h + f->radius[i]);
    }
    return high >= low ? high - low : 0;
}
