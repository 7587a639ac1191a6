/* SPDX-License-Identifier: MIT */
#include "harness/host.h"

#include "base/text.h"
#include "base/threads.h"

#include <stdio.h>
#include <unistd.h>

static void read_processor(char cpu[256])
{
    char line[512];
    snprintf(cpu, 256, "unknown");
    FILE *file = fopen("/proc/cpuinfo", "re");
    while (file && fgets(line, sizeof(line), file))
        if (sscanf(line, "model name : %255[^\n]", cpu) == 1)
            break;
    if (file)
        fclose(file);
    neph_text_clean(cpu, 256);
}

json_t *neph_host_json(void)
{
    char cpu[256];
    read_processor(cpu);
    const json_int_t memory_bytes = (json_int_t)sysconf(_SC_PHYS_PAGES) *
                                    (json_int_t)sysconf(_SC_PAGE_SIZE);
    return json_pack("{s:s, s:i, s:I}", "cpu", cpu, "cores", neph_processor_count(), "memory_bytes",
                     memory_bytes);
}

void neph_host_class(char text[NEPH_HOST_CLASS_SIZE])
{
    char cpu[256];
    read_processor(cpu);
    snprintf(text, NEPH_HOST_CLASS_SIZE, "%s x %d", cpu, neph_processor_count());
}
