/* SPDX-License-Identifier: MIT
 *
 * What of the user's environment may reach the libraries and drivers inside neph: the choice of a
 * device, caches, numbers of threads, and nothing that would change a bit of a frame unseen.
 */
#ifndef NEPH_HARNESS_SURROUNDINGS_H
#define NEPH_HARNESS_SURROUNDINGS_H

#include <stdio.h>

/* Remove from the environment what changes results without showing in an engine's version or
 * device, saying so in a line to `out`; and switch implicit Vulkan layers off. Call from main,
 * before there are threads. */
void neph_surroundings_settle(FILE *out);

#endif
