/* SPDX-License-Identifier: MIT
 *
 * Makes the masks of renderer/blue_noise.h: `make_blue_noise FILE` writes FILE where there is none,
 * and else compares the ranks in it. By hand: `cmake --build build/release --target blue_noise`.
 *
 * Void and cluster, as it is defined: each step searches all voxels. That takes half a minute.
 */
#include "base/files.h"
#include "base/png.h"
#include "renderer/blue_noise.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    SIDE = NEPH_BLUE_NOISE_SIDE_PX,
    PIXELS = NEPH_BLUE_NOISE_PIXELS,
    FRAMES = NEPH_BLUE_NOISE_FRAMES,
    HEIGHT = NEPH_BLUE_NOISE_SLICES / 3 * SIDE, /* of the file: a slice is one of R, G, B */
    TIE_BITS = 12, /* far voxels have equal energies: random bits decide between them */
};

/* Energies are integers, so that turning a voxel off undoes turning it on to the last bit. A voxel
 * has at most the energy of the whole kernel, 2 pi sigma^2 + sqrt(2 pi) sigma = 27.5: 61 bits. */
static const double energy_one = 0x1p56, sigma = 1.9;

struct field {
    int frames, size; /* voxels: frames * PIXELS */
    int64_t energies[FRAMES * PIXELS];
    bool is_on[FRAMES * PIXELS];
    int order[FRAMES * PIXELS]; /* the voxel of each rank in the whole stack */
    int64_t kernel[SIDE][SIDE], frame_kernel[FRAMES];
    uint64_t random;
};

static uint64_t next_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u); /* splitmix64 (Steele, Lea, Flood 2014) */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static int64_t energy_at(double distance2)
{
    return llrint(energy_one * exp(-0.5 * distance2 / (sigma * sigma)));
}

static double torus_distance(int difference, int period)
{
    return difference < period - difference ? difference : period - difference;
}

static void start(struct field *field)
{
    for (int i = 0; i < PIXELS; i++) {
        const double x = torus_distance(i % SIDE, SIDE), y = torus_distance(i / SIDE, SIDE);
        field->kernel[i / SIDE][i % SIDE] = energy_at(x * x + y * y);
    }
    for (int i = 0; i < field->frames; i++) {
        const double t = torus_distance(i, field->frames);
        field->frame_kernel[i] = energy_at(t * t);
    }
    for (int i = 0; i < field->size; i++)
        field->energies[i] = (int64_t)(next_random(&field->random) >> (64 - TIE_BITS));
}

static void set_voxel(struct field *field, int voxel, bool on)
{
    const int sign = on ? 1 : -1, slice = voxel / PIXELS, pixel = voxel % PIXELS;
    field->is_on[voxel] = on;
    for (int i = 0; i < PIXELS; i++) {
        const int dx = (i - pixel) & (SIDE - 1), dy = (i / SIDE - pixel / SIDE) & (SIDE - 1);
        field->energies[slice * PIXELS + i] += sign * field->kernel[dy][dx];
    }
    for (int other = 0; other < field->frames; other++)
        if (other != slice)
            field->energies[other * PIXELS + pixel] += sign *
                                                       field->frame_kernel[abs(other - slice)];
}

/* The tightest cluster of the voxels that are on (largest energy), or the largest void of those
 * that are off (smallest energy); the first of equals. */
static int search(const struct field *field, bool on)
{
    int best = -1;
    int64_t best_score = INT64_MIN;
    for (int i = 0; i < field->size; i++) {
        const int64_t score = on ? field->energies[i] : -field->energies[i];
        if (field->is_on[i] == on && score > best_score) {
            best = i;
            best_score = score;
        }
    }
    return best;
}

/* Turn on a tenth of the voxels at random. Then move the tightest cluster into the largest void
 * until that is where it was: each move makes the sum of all energies smaller. */
static int make_first_pattern(struct field *field)
{
    const int count = (field->size + 9) / 10;
    for (int done = 0; done < count;) {
        const int voxel = (int)(next_random(&field->random) % (uint64_t)field->size);
        done += !field->is_on[voxel];
        if (!field->is_on[voxel])
            set_voxel(field, voxel, true);
    }
    for (bool is_lower = true; is_lower;) {
        const int from = search(field, true);
        set_voxel(field, from, false);
        const int to = search(field, false);
        is_lower = field->energies[to] < field->energies[from];
        set_voxel(field, is_lower ? to : from, true);
    }
    return count;
}

/* Ranks of the first pattern by taking it away, of all others by filling the largest void. Beyond
 * half of the voxels Ulichney fills the tightest cluster of those that are off. That is the largest
 * void again: energies of voxels on and off add up to the whole kernel everywhere on a torus. */
static void order_voxels(struct field *field)
{
    const int first_count = make_first_pattern(field);
    for (int rank = first_count - 1; rank >= 0; rank--) {
        field->order[rank] = search(field, true);
        set_voxel(field, field->order[rank], false);
    }
    for (int rank = 0; rank < field->size; rank++) {
        if (rank >= first_count)
            field->order[rank] = search(field, false);
        set_voxel(field, field->order[rank], true);
    }
}

/* The mask in the slices of the file from `first` on; a rank is a place among the voxels of one
 * slice. */
static void make_mask(struct field *field, int frames, int first, uint16_t *rgb)
{
    int counts[FRAMES] = {0};
    *field = (struct field){.frames = frames, .size = frames * PIXELS};
    start(field);
    order_voxels(field);
    for (int i = 0; i < field->size; i++) {
        const int slice = field->order[i] / PIXELS, pixel = field->order[i] % PIXELS;
        const int place = first + slice;
        rgb[3 * (place / 3 * PIXELS + pixel) + place % 3] = (uint16_t)counts[slice]++;
    }
}

static enum neph_status compare(const char *path, const uint16_t *rgb, struct neph_diag *diag)
{
    int width_px, height_px, differing = 0;
    uint16_t *codes = NULL;
    const enum neph_status status = neph_png_read_rgb16(path, &width_px, &height_px, &codes, diag);
    if (status)
        return status;
    const bool is_of_size = width_px == SIDE && height_px == HEIGHT;
    for (int i = 0; i < NEPH_BLUE_NOISE_COUNT && is_of_size; i++)
        differing += codes[i] >> 4 != rgb[i];
    free(codes);
    if (!is_of_size || differing > 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is %dx%d and %d of its values differ", path,
                         width_px, height_px, differing);
    return NEPH_OK;
}

int main(int argc, char **argv)
{
    static struct field field;
    static uint16_t rgb[NEPH_BLUE_NOISE_COUNT];
    struct neph_diag diag = {0};
    if (argc != 2) {
        fprintf(stderr, "usage: make_blue_noise FILE\n");
        return neph_status_exit_code(NEPH_ERR_USAGE);
    }
    make_mask(&field, 1, 0, rgb);
    make_mask(&field, FRAMES, 1, rgb);
    const enum neph_status status = neph_path_exists(argv[1])
                                        ? compare(argv[1], rgb, &diag)
                                        : neph_png_write_rgb16(argv[1], SIDE, HEIGHT, 12,
                                                               NEPH_PNG_SRGB, rgb, &diag);
    if (status)
        fprintf(stderr, "make_blue_noise: %s\n", diag.message);
    return neph_status_exit_code(status);
}
