/* SPDX-License-Identifier: MIT
 *
 * The translation unit with volk's implementation.
 */
#define VOLK_IMPLEMENTATION
#include <volk.h>
