/* SPDX-License-Identifier: MIT */
#include "renderer/in_flight.h"

static const char what[] = "frames in flight";

enum neph_status neph_in_flight_begin(const struct neph_vulkan *vulkan,
                                      struct neph_in_flight *flight, int *slot,
                                      struct neph_diag *diag)
{
    const int next = (int)(flight->sent % NEPH_IN_FLIGHT_FRAMES);
    const enum neph_status status = neph_batches_wait(vulkan, flight->batches[next], what, diag);
    if (status)
        return status;
    if (flight->sent - flight->home == NEPH_IN_FLIGHT_FRAMES)
        flight->home++;
    *slot = next;
    return NEPH_OK;
}

void neph_in_flight_end(const struct neph_vulkan *vulkan, struct neph_in_flight *flight)
{
    flight->batches[flight->sent % NEPH_IN_FLIGHT_FRAMES] = neph_batches_sent(vulkan);
    flight->sent++;
}

enum neph_status neph_in_flight_home(const struct neph_vulkan *vulkan,
                                     struct neph_in_flight *flight, int *slot,
                                     struct neph_diag *diag)
{
    if (flight->home == flight->sent)
        return neph_fail(diag, NEPH_ERR_USAGE, "no frame is in flight");
    const int oldest = (int)(flight->home % NEPH_IN_FLIGHT_FRAMES);
    const enum neph_status status = neph_batches_wait(vulkan, flight->batches[oldest], what, diag);
    if (status)
        return status;
    flight->home++;
    *slot = oldest;
    return NEPH_OK;
}

enum neph_status neph_in_flight_land(const struct neph_vulkan *vulkan,
                                     struct neph_in_flight *flight, struct neph_diag *diag)
{
    flight->home = flight->sent;
    return neph_batches_wait(vulkan, neph_batches_sent(vulkan), what, diag);
}

enum neph_status neph_turns_create(const struct neph_vulkan *vulkan, const struct neph_buffer *like,
                                   const char *name, struct neph_turns *turns,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < NEPH_IN_FLIGHT_FRAMES - 1 && !status; i++)
        status = neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, like->size_bytes, name,
                                    &turns->waiting[i], diag);
    return status;
}

void neph_turns_destroy(const struct neph_vulkan *vulkan, struct neph_turns *turns)
{
    for (int i = 0; i < NEPH_IN_FLIGHT_FRAMES - 1; i++)
        neph_buffer_destroy(vulkan, &turns->waiting[i]);
}

void neph_turns_take(struct neph_turns *turns, struct neph_buffer *buffer)
{
    const struct neph_buffer used = *buffer;
    *buffer = turns->waiting[0];
    for (int i = 1; i < NEPH_IN_FLIGHT_FRAMES - 1; i++)
        turns->waiting[i - 1] = turns->waiting[i];
    turns->waiting[NEPH_IN_FLIGHT_FRAMES - 2] = used;
}
