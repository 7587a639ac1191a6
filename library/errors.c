/* SPDX-License-Identifier: MIT */
#include "library/handles.h"

#include "base/text.h"

/* The numbers of the interface, which stay when those of the house change. */
static const struct {
    enum neph_status inside;
    enum nephm_status outside;
} statuses[] = {
    {NEPH_OK, NEPHM_OK},
    {NEPH_ERR_USAGE, NEPHM_ERR_USAGE},
    {NEPH_ERR_INPUT, NEPHM_ERR_INPUT},
    {NEPH_ERR_NOT_FOUND, NEPHM_ERR_NOT_FOUND},
    {NEPH_ERR_IO, NEPHM_ERR_IO},
    {NEPH_ERR_MEMORY, NEPHM_ERR_MEMORY},
    {NEPH_ERR_UNSUPPORTED, NEPHM_ERR_UNSUPPORTED},
    {NEPH_ERR_GATE, NEPHM_ERR_GATE},
    {NEPH_ERR_INTERNAL, NEPHM_ERR_INTERNAL},
};
enum { STATUSES = sizeof(statuses) / sizeof(statuses[0]) };

int neph_library_tell(enum neph_status status, const struct neph_diag *diag,
                      struct nephm_error *error)
{
    if (error)
        error->text[0] = '\0';
    if (error && status)
        neph_text_format(error->text, sizeof(error->text), diag->hint[0] ? "%s (%s)" : "%s",
                         diag->message, diag->hint);
    for (int i = 0; i < STATUSES; i++)
        if (statuses[i].inside == status)
            return statuses[i].outside;
    return NEPHM_ERR_INTERNAL;
}

const char *nephm_version(void)
{
    return NEPH_VERSION;
}

const char *nephm_status_name(int status)
{
    for (int i = 0; i < STATUSES; i++)
        if ((int)statuses[i].outside == status)
            return neph_status_name(statuses[i].inside);
    return "unknown";
}

locale_t neph_library_enter(locale_t *inside)
{
    *inside = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    return *inside ? uselocale(*inside) : (locale_t)0;
}

void neph_library_leave(locale_t before, locale_t inside)
{
    if (!before)
        return;
    uselocale(before);
    freelocale(inside);
}
