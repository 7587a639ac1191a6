/* SPDX-License-Identifier: MIT */
#include "renderer/blue_noise.h"

#include "base/files.h"
#include "base/hash.h"
#include "base/interrupt.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- energies -------------------------------------------------------------------------------- */

/* Energies are integers, so that taking a voxel away undoes adding it to the last bit and the order
 * of additions means nothing. A voxel's energy is at most the whole kernel, 2 pi sigma^2 +
 * sqrt(2 pi) sigma = 27.5: 61 bits here. The next bit says that the voxel is on: the largest of all
 * is then the tightest cluster, and the smallest the largest void. */
static const double energy_one = 0x1p56;
static const int64_t energy_on = (int64_t)1 << 62;

/* Far voxels, and empty slices, have equal energies; the seed decides between them by this many
 * random bits that each voxel begins with, and not the order of the array. */
enum { TIE_BITS = 12, INTERRUPT_PERIOD = 1024 };

/* What is looked for: of the voxels that are off, of those that are on. */
enum kind { VOID, CLUSTER, KIND_COUNT };

struct found {
    bool is_known;
    ptrdiff_t voxel; /* -1: there is no voxel of that state */
    int64_t score;   /* the larger, the more it is what is looked for */
};

/* The fast search: what was found in each row and in each slice. */
struct known {
    struct found *rows, *slices;
};

struct field {
    int width, height, depth;
    ptrdiff_t slice_size, size;
    int64_t *energies;
    int64_t *kernel;       /* [dy * 2 * width + width + dx], dx = -width .. width - 1 */
    int64_t *frame_kernel; /* [dt], 0 .. depth - 1 */
    struct known known[KIND_COUNT];
    int reach; /* rows from a voxel on which its kernel is 0 [px] */
    uint64_t random;
};

static uint64_t next_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u); /* splitmix64 (Steele, Lea, Flood 2014) */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static int64_t energy_at(double distance2, double sigma)
{
    return llrint(energy_one * exp(-0.5 * distance2 / (sigma * sigma)));
}

/* The shorter way round. */
static double torus_distance(int difference, int period)
{
    const int there = abs(difference) % period;
    return there < period - there ? there : period - there;
}

static void fill_kernels(struct field *field)
{
    for (int dy = 0; dy < field->height; dy++)
        for (int dx = -field->width; dx < field->width; dx++) {
            const double x = torus_distance(dx, field->width);
            const double y = torus_distance(dy, field->height);
            field->kernel[(ptrdiff_t)(2 * dy + 1) * field->width + dx] = energy_at(
                x * x + y * y, NEPH_BLUE_NOISE_SIGMA_PX);
        }
    while (energy_at((double)field->reach * field->reach, NEPH_BLUE_NOISE_SIGMA_PX) != 0)
        field->reach++;
    for (int dt = 0; dt < field->depth; dt++) {
        const double t = torus_distance(dt, field->depth);
        field->frame_kernel[dt] = energy_at(t * t, NEPH_BLUE_NOISE_SIGMA_FRAMES);
    }
}

static void field_finish(struct field *field)
{
    free(field->energies);
    free(field->kernel);
    free(field->frame_kernel);
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        free(field->known[kind].rows);
        free(field->known[kind].slices);
    }
}

static enum neph_status field_start(struct field *field,
                                    const struct neph_blue_noise_request *request,
                                    struct neph_diag *diag)
{
    const size_t slice_size = (size_t)request->width_px * (size_t)request->height_px;
    const size_t depth = (size_t)request->frame_count, size = slice_size * depth;
    *field = (struct field){
        .width = request->width_px,
        .height = request->height_px,
        .depth = request->frame_count,
        .slice_size = (ptrdiff_t)slice_size,
        .size = (ptrdiff_t)size,
        .energies = calloc(size, sizeof(*field->energies)),
        .kernel = calloc(2 * slice_size, sizeof(*field->kernel)),
        .frame_kernel = calloc(depth, sizeof(*field->frame_kernel)),
        .random = request->seed,
    };
    bool has_memory = field->energies && field->kernel && field->frame_kernel;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        struct known *known = &field->known[kind];
        known->rows = calloc(depth * (size_t)request->height_px, sizeof(*known->rows));
        known->slices = calloc(depth, sizeof(*known->slices));
        has_memory &= known->rows && known->slices;
    }
    if (!has_memory) {
        field_finish(field);
        return neph_fail_memory(diag);
    }
    fill_kernels(field);
    for (ptrdiff_t i = 0; i < field->size; i++)
        field->energies[i] = (int64_t)(next_random(&field->random) >> (64 - TIE_BITS));
    return NEPH_OK;
}

/* ---- the largest void and the tightest cluster ----------------------------------------------- */

static bool is_on(const struct field *field, ptrdiff_t voxel)
{
    return field->energies[voxel] >= energy_on;
}

/* What turns an energy into a score by an exclusive or. */
static int64_t flip_of(enum kind kind)
{
    return kind == CLUSTER ? 0 : -1;
}

static int64_t score_of(const struct field *field, enum kind kind, ptrdiff_t voxel)
{
    return field->energies[voxel] ^ flip_of(kind);
}

/* The lower place wins a draw, whatever the order of the search. */
static bool is_better(int64_t score, ptrdiff_t voxel, const struct found *than)
{
    return than->voxel < 0 || score > than->score || (score == than->score && voxel < than->voxel);
}

static int64_t larger(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/* Four at a time, which do not wait for each other. */
static int64_t best_score(const int64_t *energies, int count, int64_t flip)
{
    int64_t a = INT64_MIN, b = INT64_MIN, c = INT64_MIN, d = INT64_MIN;
    int x = 0;
    for (; x + 4 <= count; x += 4) {
        a = larger(a, energies[x] ^ flip);
        b = larger(b, energies[x + 1] ^ flip);
        c = larger(c, energies[x + 2] ^ flip);
        d = larger(d, energies[x + 3] ^ flip);
    }
    for (; x < count; x++)
        a = larger(a, energies[x] ^ flip);
    return larger(larger(a, b), larger(c, d));
}

static struct found search_row(const struct field *field, enum kind kind, ptrdiff_t first)
{
    const int64_t best = best_score(field->energies + first, field->width, flip_of(kind));
    ptrdiff_t voxel = first;
    while (score_of(field, kind, voxel) != best)
        voxel++;
    const bool is_of_kind = is_on(field, voxel) == (kind == CLUSTER);
    return (struct found){true, is_of_kind ? voxel : -1, best};
}

static void keep_better(const struct found *here, struct found *best)
{
    if (here->voxel >= 0 && is_better(here->score, here->voxel, best))
        *best = *here;
}

static struct found search_slice(struct field *field, enum kind kind, int slice)
{
    struct found best = {true, -1, INT64_MIN};
    for (int row = slice * field->height; row < (slice + 1) * field->height; row++) {
        struct found *here = &field->known[kind].rows[row];
        if (!here->is_known)
            *here = search_row(field, kind, (ptrdiff_t)row * field->width);
        keep_better(here, &best);
    }
    return best;
}

/* -1 when no voxel has that state. A change leaves all slices but its own known (almost always),
 * and of its own the far rows, so that this costs some rows and not the stack. */
static ptrdiff_t search(struct field *field, enum kind kind)
{
    struct found best = {true, -1, INT64_MIN};
    for (int slice = 0; slice < field->depth; slice++) {
        struct found *here = &field->known[kind].slices[slice];
        if (!here->is_known)
            *here = search_slice(field, kind, slice);
        keep_better(here, &best);
    }
    return best.voxel;
}

/* A voxel has changed its energy alone. */
static void keep_known(struct found *best, ptrdiff_t voxel, int64_t score)
{
    if (best->voxel == voxel)
        best->is_known = false;
    else if (best->is_known && is_better(score, voxel, best))
        *best = (struct found){true, voxel, score};
}

static void forget(struct field *field, int slice, int row)
{
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        field->known[kind].slices[slice].is_known = false;
        field->known[kind].rows[row].is_known = false;
    }
}

static void add_row(int64_t *restrict energies, const int64_t *restrict kernel, int count, bool on)
{
    if (on)
        for (int x = 0; x < count; x++)
            energies[x] += kernel[x];
    else
        for (int x = 0; x < count; x++)
            energies[x] -= kernel[x];
}

static void set_voxel(struct field *field, ptrdiff_t voxel, bool on)
{
    const int slice = (int)(voxel / field->slice_size);
    const ptrdiff_t pixel = voxel % field->slice_size;
    const int voxel_x = (int)(pixel % field->width), voxel_y = (int)(pixel / field->width);
    field->energies[voxel] += on ? energy_on : -energy_on;
    for (int y = 0; y < field->height; y++) {
        const int dy = abs(y - voxel_y), row = slice * field->height + y;
        if (torus_distance(dy, field->height) >= field->reach)
            continue;
        add_row(field->energies + (ptrdiff_t)row * field->width,
                field->kernel + (ptrdiff_t)(2 * dy + 1) * field->width - voxel_x, field->width, on);
        forget(field, slice, row);
    }
    for (int other = 0; other < field->depth; other++) {
        if (other == slice)
            continue;
        const ptrdiff_t there = other * field->slice_size + pixel;
        const int64_t energy = field->frame_kernel[abs(other - slice)];
        field->energies[there] += on ? energy : -energy;
        const enum kind kind = is_on(field, there) ? CLUSTER : VOID;
        const int64_t score = score_of(field, kind, there);
        keep_known(&field->known[kind].rows[there / field->width], there, score);
        keep_known(&field->known[kind].slices[other], there, score);
    }
}

/* ---- void and cluster ------------------------------------------------------------------------ */

static enum neph_status check_interrupt(ptrdiff_t step, struct neph_diag *diag)
{
    if (step % INTERRUPT_PERIOD == 0 && neph_interrupted())
        return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted while making blue noise");
    return NEPH_OK;
}

/* A tenth of the voxels, at random. */
static ptrdiff_t turn_on_some(struct field *field)
{
    const ptrdiff_t count = (field->size + 9) / 10;
    for (ptrdiff_t done = 0; done < count;) {
        const ptrdiff_t voxel = (ptrdiff_t)(next_random(&field->random) % (uint64_t)field->size);
        if (is_on(field, voxel))
            continue;
        set_voxel(field, voxel, true);
        done++;
    }
    return count;
}

/* Move the tightest cluster into the largest void until that is where it came from. Each move makes
 * the sum of all energies smaller, so this ends. */
static enum neph_status spread(struct field *field, struct neph_diag *diag)
{
    for (ptrdiff_t step = 1;; step++) {
        const enum neph_status status = check_interrupt(step, diag);
        if (status)
            return status;
        const ptrdiff_t from = search(field, CLUSTER);
        set_voxel(field, from, false);
        const ptrdiff_t to = search(field, VOID);
        const bool is_lower = field->energies[to] < field->energies[from]; /* both are off */
        set_voxel(field, is_lower ? to : from, true);
        if (!is_lower)
            return NEPH_OK;
    }
}

/* `order[rank]` is the voxel of that rank in the whole stack. */
static enum neph_status rank_voxels(struct field *field, ptrdiff_t *order, struct neph_diag *diag)
{
    const ptrdiff_t first_count = turn_on_some(field);
    enum neph_status status = spread(field, diag);
    /* Phase 1: the ranks of the first pattern, by taking it away, and putting it back. */
    for (ptrdiff_t rank = first_count - 1; rank >= 0 && !status; rank--) {
        order[rank] = search(field, CLUSTER);
        set_voxel(field, order[rank], false);
        status = check_interrupt(rank, diag);
    }
    for (ptrdiff_t rank = 0; rank < first_count && !status; rank++)
        set_voxel(field, order[rank], true);
    /* Phases 2 and 3. In phase 3, beyond half of the voxels, Ulichney fills the tightest cluster of
     * voxels that are off. That is the largest void again: the energies from voxels on and off add
     * up to the whole kernel everywhere on a torus. */
    for (ptrdiff_t rank = first_count; rank < field->size && !status; rank++) {
        order[rank] = search(field, VOID);
        set_voxel(field, order[rank], true);
        status = check_interrupt(rank, diag);
    }
    return status;
}

static void rank_by_slice(const struct field *field, const ptrdiff_t *order, int *counts,
                          uint16_t *ranks)
{
    for (ptrdiff_t rank = 0; rank < field->size; rank++)
        ranks[order[rank]] = (uint16_t)counts[order[rank] / field->slice_size]++;
}

static enum neph_status make_ranks(const struct neph_blue_noise_request *request, uint16_t *ranks,
                                   struct neph_diag *diag)
{
    struct field field;
    enum neph_status status = field_start(&field, request, diag);
    if (status)
        return status;
    ptrdiff_t *order = calloc((size_t)field.size, sizeof(*order));
    int *counts = calloc((size_t)field.depth, sizeof(*counts));
    status = order && counts ? rank_voxels(&field, order, diag) : neph_fail_memory(diag);
    if (!status)
        rank_by_slice(&field, order, counts, ranks);
    free(counts);
    free(order);
    field_finish(&field);
    return status;
}

/* ---- masks ----------------------------------------------------------------------------------- */

static bool is_within(int value, int most)
{
    return value >= 1 && value <= most;
}

static size_t voxel_count(const struct neph_blue_noise_request *request)
{
    return (size_t)request->width_px * (size_t)request->height_px * (size_t)request->frame_count;
}

static enum neph_status mask_start(const struct neph_blue_noise_request *request,
                                   struct neph_blue_noise **noise, struct neph_diag *diag)
{
    if (!is_within(request->width_px, NEPH_BLUE_NOISE_SIDE_MAX_PX) ||
        !is_within(request->height_px, NEPH_BLUE_NOISE_SIDE_MAX_PX) ||
        !is_within(request->frame_count, NEPH_BLUE_NOISE_FRAMES_MAX))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "blue noise of %dx%d pixels and %d frames",
                         request->width_px, request->height_px, request->frame_count);
    struct neph_blue_noise *made = calloc(1, sizeof(*made));
    if (made)
        made->ranks = calloc(voxel_count(request), sizeof(*made->ranks));
    if (!made || !made->ranks) {
        neph_blue_noise_destroy(made);
        return neph_fail_memory(diag);
    }
    made->request = *request;
    *noise = made;
    return NEPH_OK;
}

enum neph_status neph_blue_noise_create(const struct neph_blue_noise_request *request,
                                        struct neph_blue_noise **noise, struct neph_diag *diag)
{
    struct neph_blue_noise *made = NULL;
    enum neph_status status = mask_start(request, &made, diag);
    if (status)
        return status;
    status = make_ranks(request, made->ranks, diag);
    if (status)
        neph_blue_noise_destroy(made);
    else
        *noise = made;
    return status;
}

void neph_blue_noise_destroy(struct neph_blue_noise *noise)
{
    if (!noise)
        return;
    free(noise->ranks);
    free(noise);
}

/* ---- the cache ------------------------------------------------------------------------------- */

char *neph_blue_noise_path(const struct neph_blue_noise_request *request, const char *cache_folder)
{
    char name[128];
    snprintf(name, sizeof(name), "blue-noise-v%d-%dx%dx%d-seed%" PRIu64 ".bin",
             NEPH_BLUE_NOISE_VERSION, request->width_px, request->height_px, request->frame_count,
             request->seed);
    return neph_path_join(cache_folder, name);
}

/* The whole file that belongs to a mask. */
static enum neph_status encode(const struct neph_blue_noise *noise, char **data, size_t *size,
                               struct neph_diag *diag)
{
    const struct neph_blue_noise_request *request = &noise->request;
    const size_t count = voxel_count(request);
    unsigned char *body = malloc(2 * count);
    char *file = NULL, hash[NEPH_HASH_HEX_SIZE], line[256];
    enum neph_status status = body ? NEPH_OK : neph_fail_memory(diag);
    for (size_t i = 0; i < count && !status; i++) {
        body[2 * i] = (unsigned char)(noise->ranks[i] & 0xff);
        body[2 * i + 1] = (unsigned char)(noise->ranks[i] >> 8);
    }
    if (!status)
        status = neph_hash(body, 2 * count, hash, diag);
    if (status)
        goto done;
    const size_t line_size = (size_t)snprintf(
        line, sizeof(line), "neph-blue-noise %d %d %d %d %" PRIu64 " %s\n", NEPH_BLUE_NOISE_VERSION,
        request->width_px, request->height_px, request->frame_count, request->seed, hash);
    file = malloc(line_size + 2 * count);
    if (!file) {
        status = neph_fail_memory(diag);
        goto done;
    }
    memcpy(file, line, line_size);
    memcpy(file + line_size, body, 2 * count);
    *data = file;
    *size = line_size + 2 * count;
done:
    free(body);
    return status;
}

/* Take the ranks that end a file, and see whether the whole file is what they would be written as:
 * size, request and hash are then right. */
static bool decode(const char *data, size_t size, struct neph_blue_noise *noise)
{
    const size_t count = voxel_count(&noise->request);
    if (size < 2 * count)
        return false;
    const unsigned char *body = (const unsigned char *)data + size - 2 * count;
    for (size_t i = 0; i < count; i++)
        noise->ranks[i] = (uint16_t)(body[2 * i] | body[2 * i + 1] << 8);
    char *expected = NULL;
    size_t expected_size = 0;
    if (encode(noise, &expected, &expected_size, NULL))
        return false;
    const bool is_whole = size == expected_size && memcmp(data, expected, size) == 0;
    free(expected);
    return is_whole;
}

/* NULL when there is no whole file; that is no failure. */
static struct neph_blue_noise *read_mask(const char *path,
                                         const struct neph_blue_noise_request *request)
{
    const size_t limit_bytes = 2 * voxel_count(request) + 256;
    struct neph_blue_noise *noise = NULL;
    char *data = NULL;
    size_t size = 0;
    if (neph_file_read(path, limit_bytes, &data, &size, NULL))
        return NULL;
    if (!mask_start(request, &noise, NULL) && !decode(data, size, noise)) {
        neph_blue_noise_destroy(noise);
        noise = NULL;
    }
    free(data);
    return noise;
}

static enum neph_status write_mask(const char *path, const char *cache_folder,
                                   const struct neph_blue_noise *noise, struct neph_diag *diag)
{
    char *data = NULL;
    size_t size = 0;
    enum neph_status status = encode(noise, &data, &size, diag);
    if (!status)
        status = neph_dir_create(cache_folder, diag);
    if (!status)
        status = neph_file_write(path, data, size, diag);
    free(data);
    return status;
}

enum neph_status neph_blue_noise_load(const struct neph_blue_noise_request *request,
                                      const char *cache_folder, struct neph_blue_noise **noise,
                                      struct neph_diag *diag)
{
    char *path = neph_blue_noise_path(request, cache_folder);
    if (!path)
        return neph_fail_memory(diag);
    enum neph_status status = NEPH_OK;
    struct neph_blue_noise *made = read_mask(path, request);
    if (!made) {
        status = neph_blue_noise_create(request, &made, diag);
        if (!status)
            status = write_mask(path, cache_folder, made, diag);
    }
    free(path);
    if (status)
        neph_blue_noise_destroy(made);
    else
        *noise = made;
    return status;
}
