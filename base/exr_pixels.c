/* SPDX-License-Identifier: MIT */
#include "base/exr_pixels.h"

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
    const uint64_t expected_bytes = layout->pixel_bytes * (uint64_t)block->width_px *
                                    (uint64_t)block->height_px;
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
    const size_t first = (size_t)block->row * (size_t)image->width_px + (size_t)block->column;
    for (int c = 0; c < decoder->channel_count; c++) {
        exr_coding_channel_info_t *channel = &decoder->channels[c];
        channel->decode_to_ptr = (uint8_t *)(image->channels[c].samples + first);
        neph_exr_float_rows(channel, image->width_px);
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
