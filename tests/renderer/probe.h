/* SPDX-License-Identifier: MIT
 *
 * Probe shaders: each thread evaluates a shader function for one input, and the test compares the
 * result with the formula in C.
 */
#ifndef NEPH_TESTS_PROBE_H
#define NEPH_TESTS_PROBE_H

#include "tests/renderer/renderer_test.h"

#include "renderer/compute.h"
#include "renderer/gpu_scene.h"

/* Runs a probe. The last two buffers of the kernel are its inputs and its results; the buffers
 * before them are the scene's (`scene` may be NULL). A group has 64 threads, one per input. The
 * caller frees the results. */
static inline void *test_probe(struct neph_vulkan *vulkan, const struct neph_kernel_params *params,
                               const struct neph_gpu_scene *scene, const void *questions,
                               size_t question_bytes, size_t answer_bytes, int count)
{
    const size_t in_bytes = (size_t)count * question_bytes,
                 out_bytes = (size_t)count * answer_bytes;
    const int first = params->buffer_count - 2;
    const struct neph_kernel *kernel;
    struct neph_buffer in = {0}, out = {0}, readback = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_kernel_get(vulkan, params, &kernel, &diag), &diag);
    neph_assert_ok(
        neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, in_bytes, "questions", &in, &diag), &diag);
    neph_assert_ok(
        neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, out_bytes, "answers", &out, &diag), &diag);
    neph_assert_ok(
        neph_buffer_create(vulkan, NEPH_BUFFER_READBACK, out_bytes, "readback", &readback, &diag),
        &diag);
    memcpy(in.mapped, questions, in_bytes);
    struct neph_dispatch dispatch = {.group_count = ((uint32_t)count + 63) / 64,
                                     .copy_from = &out,
                                     .copy_to = &readback,
                                     .copy_size_bytes = out_bytes};
    dispatch.buffers[first] = &in;
    dispatch.buffers[first + 1] = &out;
    if (scene)
        neph_gpu_scene_bind(scene, &dispatch);
    neph_assert_ok(neph_kernel_run(vulkan, kernel, &dispatch, NULL, &diag), &diag);
    void *answers = malloc(out_bytes);
    assert_non_null(answers);
    memcpy(answers, readback.mapped, out_bytes);
    neph_buffer_destroy(vulkan, &readback);
    neph_buffer_destroy(vulkan, &out);
    neph_buffer_destroy(vulkan, &in);
    return answers;
}

#endif
