/* SPDX-License-Identifier: MIT */
#include "scenes/hash_text.h"

#include <string.h>

/* -0 and 0 render the same and hash the same. */
static double remove_negative_zero(double value)
{
    return value + 0.0;
}

void neph_put_number(FILE *text, const char *name, double value)
{
    fprintf(text, "%s %.17g\n", name, remove_negative_zero(value));
}

void neph_put_three(FILE *text, const char *name, double a, double b, double c)
{
    fprintf(text, "%s %.17g %.17g %.17g\n", name, remove_negative_zero(a), remove_negative_zero(b),
            remove_negative_zero(c));
}

void neph_put_vec3(FILE *text, const char *name, struct neph_vec3 v)
{
    neph_put_three(text, name, v.x, v.y, v.z);
}

void neph_put_rgb(FILE *text, const char *name, struct neph_rgb c)
{
    neph_put_three(text, name, c.r, c.g, c.b);
}

void neph_put_text(FILE *text, const char *name, const char *value)
{
    fprintf(text, "%s %zu %s\n", name, value ? strlen(value) : 0, value ? value : "");
}
