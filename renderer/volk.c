/* SPDX-License-Identifier: MIT
 *
 * The one translation unit that holds volk's implementation.
 */
#define VOLK_IMPLEMENTATION
#include <volk.h>
