/* SPDX-License-Identifier: MIT
 *
 * The looks of meshes in the layout of shaders/mesh_looks.glsl, among the words of gpu_meshes.h.
 */
#ifndef NEPH_RENDERER_GPU_MESH_LOOKS_H
#define NEPH_RENDERER_GPU_MESH_LOOKS_H

#include "scenes/scene.h"

#include <stdint.h>

/* Bits of specialization constant 0. */
uint32_t neph_gpu_mesh_look_bits(const struct neph_scene *scene);

/* The number of words of four of a mesh's look; 0: it has none. */
size_t neph_gpu_mesh_look_words(const struct neph_mesh *mesh);

/* The number of words of all textures; each is there once. A word of four is a texel. */
size_t neph_gpu_mesh_texture_words(const struct neph_scene *scene);

/* Write the look of the scene's mesh `index` to `words + first`, and its texture, if no mesh before
 * it has the same, to its place among all, of which the first is `words + textures`. */
void neph_gpu_mesh_look_write(const struct neph_scene *scene, int index, uint32_t first,
                              uint32_t textures, uint32_t (*words)[4]);

#endif
