/* SPDX-License-Identifier: MIT
 *
 * The colour spaces of a user's OpenColorIO config, for neph_colour_convert(). The config is
 * trusted as the command line is: it and the tables that it names are read in this process.
 */
#ifndef NEPH_METRICS_COLOUR_CONFIG_H
#define NEPH_METRICS_COLOUR_CONFIG_H

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

struct neph_colour_source; /* base/colour_convert.h */

/* Read a config of at most 16 MiB. Names are those of its spaces, their aliases, and its roles, in
 * any case of letters. `space` is its name of linear Rec.709 with white D65; NULL: colours are
 * converted to the role aces_interchange (ACES2065-1) and from there by the matrix of
 * base/chromaticities.h. Tables are found as the config says; variables in their paths have the
 * defaults of its `environment`, never values of the shell. Conversion is in float, without
 * approximate functions, and is the same for any number of threads.
 *
 * Errors of neph_file_open(). NEPH_ERR_INPUT: OpenColorIO cannot read the config, it has no space
 * of that name, or no role aces_interchange. When colours are converted: a table is missing, has
 * NaN, or a result is not finite; the space is data. */
enum neph_status neph_colour_config_open(const char *path, const char *space,
                                         struct neph_colour_source **source,
                                         struct neph_diag *diag);

/* NULL is fine. */
void neph_colour_config_close(struct neph_colour_source *source);

#ifdef __cplusplus
}
#endif

#endif
