/* SPDX-License-Identifier: MIT
 *
 * Colour profiles: those that are sRGB also are with bytes behind them.
 */
#include "tests/fuzz/fuzz.h"

#include "base/icc.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (!neph_icc_is_srgb(data, size))
        return 0;
    uint8_t *longer = calloc(size + 4, 1);
    memcpy(longer, data, size);
    fuzz_require(neph_icc_is_srgb(longer, size + 4), "bytes behind a profile have no effect");
    free(longer);
    return 0;
}
