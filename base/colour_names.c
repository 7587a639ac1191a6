/* SPDX-License-Identifier: MIT */
#include "base/colour_names.h"

#include <stddef.h>
#include <string.h>

/* r g b and red green blue: what OpenEXR's HTJ2K encoder takes for a colour, too. rgba: Nuke's name
 * of the main layer. */
static const struct neph_colour_names known[] = {
    {{"R", "G", "B"}, false},
    {{"r", "g", "b"}, false},
    {{"red", "green", "blue"}, false},
    {{"Red", "Green", "Blue"}, false},
    {{"rgba.R", "rgba.G", "rgba.B"}, false},
    {{"rgba.r", "rgba.g", "rgba.b"}, false},
    {{"rgba.red", "rgba.green", "rgba.blue"}, false},
    {{"rgb.R", "rgb.G", "rgb.B"}, false},
    {{"Y", "Y", "Y"}, true},
    {{"L", "L", "L"}, true},
    {{"R", "R", "R"}, true},
};

const struct neph_colour_names *neph_colour_names_at(int index)
{
    return (size_t)index < sizeof(known) / sizeof(known[0]) ? &known[index] : NULL;
}

static bool has_other_colour(const char *grey, bool (*has)(const void *context, const char *name),
                             const void *context)
{
    static const char *const colours[] = {"R", "G", "B", "Y", "L", "RY", "BY"};
    for (size_t i = 0; i < sizeof(colours) / sizeof(colours[0]); i++)
        if (strcmp(colours[i], grey) != 0 && has(context, colours[i]))
            return true;
    return false;
}

bool neph_colour_names_fit(const struct neph_colour_names *names,
                           bool (*has)(const void *context, const char *name), const void *context)
{
    for (int c = 0; c < 3; c++)
        if (!has(context, names->names[c]))
            return false;
    return !names->is_grey || !has_other_colour(names->names[0], has, context);
}
