/* SPDX-License-Identifier: MIT */
#include "harness/engines/povray_text.h"

#include "harness/engines/povray_exposure.h"
#include "scenes/bounds.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdarg.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_POVRAY_KIND_COUNT == 6, "a new kind");

/* Write a number. All text except fixed words passes through here. */
static void number(struct neph_povray_writer *writer, double value)
{
    if (!isfinite(value))
        writer->not_a_number = true;
    fprintf(writer->stream, "%.17g", value);
}

static void triple(struct neph_povray_writer *writer, double a, double b, double c)
{
    fputs("<", writer->stream);
    number(writer, a);
    fputs(", ", writer->stream);
    number(writer, b);
    fputs(", ", writer->stream);
    number(writer, c);
    fputs(">", writer->stream);
}

/* Write a colour of light. In BEAUTY it is the plain colour; else gain * value in three brackets.
 * With photons all three are equal, because photons would lose the darkest bracket. */
static void light_colour(struct neph_povray_writer *writer, struct neph_rgb value)
{
    static const double alike[] = {1.0, 1.0, 1.0};
    const double gain = writer->pass->gain;
    const double bright = gain * neph_povray_component(value, writer->pass->channel);
    const double *scales = neph_povray_has_photons(writer->world->scene)
                               ? alike
                               : neph_povray_bracket_scales;
    if (writer->pass->kind == NEPH_POVRAY_BEAUTY)
        triple(writer, gain * value.r, gain * value.g, gain * value.b);
    else
        triple(writer, scales[0] * bright, scales[1] * bright, scales[2] * bright);
}

/* Write a colour of matter, without gain. */
static void matter_colour(struct neph_povray_writer *writer, struct neph_rgb value)
{
    const double grey = neph_povray_component(value, writer->pass->channel);
    if (writer->pass->kind == NEPH_POVRAY_BEAUTY)
        triple(writer, value.r, value.g, value.b);
    else
        triple(writer, grey, grey, grey);
}

static void vector(struct neph_povray_writer *writer, struct neph_vec3 v)
{
    triple(writer, v.x, v.y, v.z);
}

static void write_value(struct neph_povray_writer *writer, char kind, va_list *values)
{
    switch (kind) {
    case 'n':
        number(writer, va_arg(*values, double));
        break;
    case 'i':
        number(writer, va_arg(*values, int));
        break;
    case 's':
        fputs(va_arg(*values, const char *), writer->stream);
        break;
    case 'v':
        vector(writer, va_arg(*values, struct neph_vec3));
        break;
    case 'p':
        fputs("P(", writer->stream);
        vector(writer, va_arg(*values, struct neph_vec3));
        fputs(")", writer->stream);
        break;
    case 'l':
        fputs("rgb ", writer->stream);
        light_colour(writer, va_arg(*values, struct neph_rgb));
        break;
    case 'm':
        fputs("rgb ", writer->stream);
        matter_colour(writer, va_arg(*values, struct neph_rgb));
        break;
    }
}

void neph_povray_write_text(struct neph_povray_writer *writer, const char *text, ...)
{
    va_list values;
    va_start(values, text);
    for (const char *at = text; *at; at++)
        if (*at == '%')
            write_value(writer, *++at, &values);
        else
            fputc(*at, writer->stream);
    va_end(values);
}

bool neph_povray_has_radiosity(const struct neph_povray_writer *writer)
{
    return writer->world->radiosity.rays > 0 &&
           (writer->pass->kind == NEPH_POVRAY_BEAUTY || writer->pass->kind == NEPH_POVRAY_SURFACE);
}

/* Row i of POV-Ray's matrix is the image of unit vector i. */
void neph_povray_write_turn(struct neph_povray_writer *writer, const struct neph_turn *turn,
                            const struct neph_bounds *box)
{
    const struct neph_vec3 middle_m = neph_bounds_middle(box);
    if (!neph_is_turned(turn))
        return;
    neph_povray_write_text(writer, " translate -%p matrix <", middle_m);
    for (int axis = 0; axis < 3; axis++) {
        const struct neph_vec3 unit = {axis == 0, axis == 1, axis == 2};
        const struct neph_vec3 row = neph_rotate(turn, unit);
        for (int i = 0; i < 3; i++)
            neph_povray_write_text(writer, "%n, ", neph_povray_axis(row, i));
    }
    neph_povray_write_text(writer, "0, 0, 0> translate %p", middle_m);
}
