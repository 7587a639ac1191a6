/* SPDX-License-Identifier: MIT */
#include "renderer/blue_noise.h"

#include "base/hash.h"
#include "base/png.h"

#include <stdlib.h>
#include <string.h>

/* `b2sum -l 256 renderer/blue_noise.png` */
static const char file_hash[] = "89d0eb841695cd5cea1180e2485775683c02b7eee81f60b4f86b429d87299895";

static enum neph_status check_file(const char *path, struct neph_diag *diag)
{
    char hash[NEPH_HASH_HEX_SIZE];
    enum neph_status status = neph_hash_file(path, hash, diag);
    if (!status && strcmp(hash, file_hash) != 0)
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "the blue noise in '%s' is damaged, or of another version of neph",
                           path);
    if (status)
        neph_hint(diag, "it is a part of neph: install neph again, or set NEPH_DATA_DIR to the "
                        "folder with scenes/, scripts/ and renderer/blue_noise.png");
    return status;
}

static uint32_t pcg(uint32_t value)
{
    const uint32_t state = value * 747796405u + 2891336453u;
    const uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return word >> 22 ^ word;
}

enum neph_status neph_blue_noise_load(const char *path, uint32_t seed,
                                      uint32_t ranks[NEPH_BLUE_NOISE_COUNT], struct neph_diag *diag)
{
    enum { SIDE = NEPH_BLUE_NOISE_SIDE_PX, FRAMES = NEPH_BLUE_NOISE_FRAMES };
    int width_px, height_px;
    uint16_t *rgb = NULL;
    enum neph_status status = check_file(path, diag);
    if (!status)
        status = neph_png_read_rgb16(path, &width_px, &height_px, &rgb, diag);
    if (status)
        return status;
    const uint32_t shift = pcg(seed);
    for (uint32_t slice = 0; slice < NEPH_BLUE_NOISE_SLICES; slice++) {
        const uint32_t from = slice == 0 ? 0 : 1 + (slice - 1 + (shift >> 12)) % FRAMES;
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++) {
                const uint32_t row = from / 3 * SIDE + (y + (shift >> 6)) % SIDE;
                *ranks++ = rgb[3 * (row * SIDE + (x + shift) % SIDE) + from % 3] >> 4;
            }
    }
    free(rgb);
    return NEPH_OK;
}
