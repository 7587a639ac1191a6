/* SPDX-License-Identifier: MIT */
#include "base/build_id.h"

#include <elf.h>
#include <link.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define SHOWN_BYTES ((NEPH_BUILD_ID_SIZE - 1) / 2)

static size_t padded(size_t size)
{
    return (size + 3) & ~(size_t)3;
}

/* Notes are consecutive: a header, the owner's name and the contents, each padded to 4 bytes. */
static const unsigned char *find_id(const unsigned char *notes, size_t size)
{
    while (size >= sizeof(ElfW(Nhdr))) {
        ElfW(Nhdr) head;
        memcpy(&head, notes, sizeof(head));
        const unsigned char *name = notes + sizeof(head);
        const size_t whole = sizeof(head) + padded(head.n_namesz) + padded(head.n_descsz);
        if (whole > size)
            return NULL;
        if (head.n_type == NT_GNU_BUILD_ID && head.n_namesz == sizeof(ELF_NOTE_GNU) &&
            memcmp(name, ELF_NOTE_GNU, sizeof(ELF_NOTE_GNU)) == 0 && head.n_descsz >= SHOWN_BYTES)
            return name + padded(head.n_namesz);
        notes += whole;
        size -= whole;
    }
    return NULL;
}

/* dl_iterate_phdr() visits the program itself first; the result 1 ends the iteration there. */
static int look_at_program(struct dl_phdr_info *program, size_t size, void *context)
{
    const unsigned char **id = context;
    (void)size;
    for (int i = 0; i < program->dlpi_phnum && !*id; i++) {
        const ElfW(Phdr) *part = &program->dlpi_phdr[i];
        if (part->p_type == PT_NOTE)
            *id = find_id((const unsigned char *)(program->dlpi_addr + part->p_vaddr),
                          part->p_memsz);
    }
    return 1;
}

enum neph_status neph_build_id(char hex[NEPH_BUILD_ID_SIZE], struct neph_diag *diag)
{
    const unsigned char *id = NULL;
    dl_iterate_phdr(look_at_program, &id);
    if (!id)
        return neph_fail(diag, NEPH_ERR_IO,
                         "this program has no build id: link it with -Wl,--build-id=sha1");
    for (int i = 0; i < SHOWN_BYTES; i++)
        snprintf(hex + 2 * i, 3, "%02x", id[i]);
    return NEPH_OK;
}
