/* SPDX-License-Identifier: MIT */
#include "base/exr_pixels.h"

#include "base/exr_header.h"
#include "base/half.h"

#include <string.h>

enum {
    /* Upper bound of the compression ratio of all readable compressions: zeros by PXR24 reach
     * 1376:1 (deflate's 1032:1 on three of four bytes), all others less. */
    COMPRESSION_RATIO_MAX = 2048,
};

/* The pixels of a chunk, in the image. */
struct block {
    int column, row; /* of the first pixel */
    int width_px, height_px;
};

static int min_int(int a, int b)
{
    return a < b ? a : b;
}

static struct block first_block(const struct neph_exr_layout *layout)
{
    return (struct block){.width_px = min_int(layout->block_width_px, layout->width_px),
                          .height_px = min_int(layout->block_height_px, layout->height_px)};
}

/* Move to the next block, from left to right and from top to bottom; false behind the last one. */
static bool next_block(const struct neph_exr_layout *layout, struct block *block)
{
    block->column += block->width_px;
    if (block->column >= layout->width_px) {
        block->column = 0;
        block->row += block->height_px;
    }
    block->width_px = min_int(layout->block_width_px, layout->width_px - block->column);
    block->height_px = min_int(layout->block_height_px, layout->height_px - block->row);
    return block->row < layout->height_px;
}

/* Number of multiples of `step` in first..first + count - 1. */
static int count_samples(int first, int count, int step)
{
    return (first + count + step - 1) / step - (first + step - 1) / step;
}

/* Bytes of the samples of a block, uncompressed. */
static uint64_t count_bytes(const struct neph_exr_layout *layout, const struct block *block)
{
    uint64_t bytes = 0;
    for (int c = 0; c < layout->channels->num_channels; c++) {
        const exr_attr_chlist_entry_t *channel = &layout->channels->entries[c];
        const uint64_t sample_bytes = channel->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
        bytes += sample_bytes *
                 (uint64_t)count_samples(block->column, block->width_px, channel->x_sampling) *
                 (uint64_t)count_samples(block->row, block->height_px, channel->y_sampling);
    }
    return bytes;
}

static exr_result_t read_chunk_place(exr_const_context_t context,
                                     const struct neph_exr_layout *layout,
                                     const struct block *block, exr_chunk_info_t *chunk)
{
    const int tile[2] = {block->column / layout->block_width_px,
                         block->row / layout->block_height_px};
    const int y = layout->window.min.y + block->row;
    const exr_result_t result = layout->is_tiled
                                    ? exr_read_tile_chunk_info(context, layout->part, tile[0],
                                                               tile[1], 0, 0, chunk)
                                    : exr_read_scanline_chunk_info(context, layout->part, y, chunk);
    if (result)
        return result;
    const bool is_there = layout->is_tiled
                              ? chunk->start_x == tile[0] && chunk->start_y == tile[1] &&
                                    chunk->level_x == 0 && chunk->level_y == 0
                              : chunk->start_y == y;
    return is_there ? EXR_ERR_SUCCESS : EXR_ERR_CORRUPT_CHUNK;
}

/* Find the chunk of a block and compare its sizes with the header: the decoders trust these sizes
 * and allocate memory by them. */
static exr_result_t find_chunk(exr_const_context_t context, const struct neph_exr_layout *layout,
                               const struct block *block, exr_chunk_info_t *chunk)
{
    const exr_result_t result = read_chunk_place(context, layout, block, chunk);
    if (result)
        return result;
    const uint64_t expected_bytes = count_bytes(layout, block);
    const bool packed = layout->compression != EXR_COMPRESSION_NONE;
    if (chunk->width != block->width_px || chunk->height != block->height_px ||
        chunk->unpacked_size != expected_bytes || chunk->packed_size < 1 ||
        chunk->packed_size > expected_bytes ||
        chunk->packed_size < expected_bytes / COMPRESSION_RATIO_MAX ||
        (!packed && chunk->packed_size != expected_bytes))
        return EXR_ERR_CORRUPT_CHUNK;
    return EXR_ERR_SUCCESS;
}

exr_result_t neph_exr_check_chunks(exr_const_context_t context,
                                   const struct neph_exr_layout *layout)
{
    exr_result_t result = EXR_ERR_SUCCESS;
    struct block block = first_block(layout);
    do {
        exr_chunk_info_t chunk;
        result = find_chunk(context, layout, &block, &chunk);
    } while (!result && next_block(layout, &block));
    return result;
}

/* ---- decoding -------------------------------------------------------------------------------- */

/* Set the output pointers; the image's channels are in the order of the file. */
static void set_targets(exr_decode_pipeline_t *decoder, const struct neph_image *image,
                        const struct block *block)
{
    for (int c = 0; c < decoder->channel_count; c++) {
        exr_coding_channel_info_t *channel = &decoder->channels[c];
        const int width_px = image->width_px / channel->x_samples,
                  row = count_samples(0, block->row, channel->y_samples);
        channel->decode_to_ptr = (uint8_t *)(image->channels[c].samples +
                                             (size_t)row * (size_t)width_px +
                                             (size_t)block->column);
        neph_exr_float_rows(channel, width_px);
    }
}

/* The library's own decompression function; lives as long as the decoder. */
struct decompressor {
    exr_result_t (*run)(exr_decode_pipeline_t *decoder);
};

/* A chunk that compression would not shrink is stored uncompressed. OpenEXRCore 3.1.5 decompresses
 * it all the same for B44 and B44A: floats and integers, which these do not compress, are then
 * returned channel by channel although they are stored line by line, without an error. */
static exr_result_t decompress_or_copy(exr_decode_pipeline_t *decoder)
{
    const struct decompressor *decompressor = decoder->decoding_user_data;
    if (decoder->chunk.packed_size != decoder->chunk.unpacked_size)
        return decompressor->run(decoder);
    if (decoder->unpacked_buffer != decoder->packed_buffer)
        memcpy(decoder->unpacked_buffer, decoder->packed_buffer, decoder->chunk.packed_size);
    return EXR_ERR_SUCCESS;
}

static float read_sample(const uint8_t *at, uint16_t type)
{
    if (type == EXR_PIXEL_HALF)
        return neph_half_to_float((uint16_t)(at[0] | at[1] << 8));
    return type == EXR_PIXEL_FLOAT ? neph_exr_f32(at) : (float)neph_exr_u32(at);
}

/* In place of the library's function: OpenEXRCore 3.1.5 counts the rows that have samples of a
 * subsampled channel from the first row of the chunk, not from row 0. The size of the unpacked
 * samples is that of count_bytes(). */
static exr_result_t unpack_subsampled(exr_decode_pipeline_t *decoder)
{
    const uint8_t *at = decoder->unpacked_buffer;
    for (int y = 0; y < decoder->chunk.height; y++)
        for (int c = 0; c < decoder->channel_count; c++) {
            const exr_coding_channel_info_t *channel = &decoder->channels[c];
            const int row = decoder->chunk.start_y + y, width = decoder->chunk.width,
                      step = channel->y_samples;
            if (row % step != 0)
                continue;
            float *samples = (float *)(void *)channel->decode_to_ptr +
                             (size_t)(y / step) * (size_t)(width / channel->x_samples);
            for (int x = 0; x < width / channel->x_samples; x++, at += channel->bytes_per_element)
                samples[x] = read_sample(at, channel->data_type);
        }
    return EXR_ERR_SUCCESS;
}

static exr_result_t choose_decoding(exr_const_context_t context, int part,
                                    exr_decode_pipeline_t *decoder,
                                    struct decompressor *decompressor)
{
    exr_result_t result = exr_decoding_choose_default_routines(context, part, decoder);
    if (result || !decoder->decompress_fn)
        return result;
    decompressor->run = decoder->decompress_fn;
    decoder->decoding_user_data = decompressor;
    decoder->decompress_fn = decompress_or_copy;
    return EXR_ERR_SUCCESS;
}

static exr_result_t read_chunk(exr_const_context_t context, const struct neph_exr_layout *layout,
                               exr_decode_pipeline_t *decoder, struct decompressor *decompressor,
                               const struct neph_image *image, const struct block *block)
{
    exr_chunk_info_t chunk;
    exr_result_t result = find_chunk(context, layout, block, &chunk);
    if (result)
        return result;
    const bool first = block->row == 0 && block->column == 0;
    result = first ? exr_decoding_initialize(context, layout->part, &chunk, decoder)
                   : exr_decoding_update(context, layout->part, &chunk, decoder);
    if (result)
        return result;
    set_targets(decoder, image, block);
    if (first)
        result = choose_decoding(context, layout->part, decoder, decompressor);
    if (layout->is_subsampled)
        decoder->unpack_and_convert_fn = unpack_subsampled;
    return result ? result : exr_decoding_run(context, layout->part, decoder);
}

exr_result_t neph_exr_read_pixels(exr_const_context_t context, const struct neph_exr_layout *layout,
                                  const struct neph_image *image)
{
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    struct decompressor decompressor = {NULL};
    exr_result_t result = EXR_ERR_SUCCESS;
    struct block block = first_block(layout);
    do
        result = read_chunk(context, layout, &decoder, &decompressor, image, &block);
    while (!result && next_block(layout, &block));
    exr_decoding_destroy(context, &decoder);
    return result;
}
