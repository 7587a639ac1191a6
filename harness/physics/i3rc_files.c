/* SPDX-License-Identifier: MIT */
#include "harness/physics/i3rc_files.h"

#include "base/files.h"
#include "base/path.h"
#include "scenes/text_numbers.h"

#include <stdlib.h>

const char neph_i3rc_address[] =
    "the clouds: https://github.com/RobertPincus/i3rc-monte-carlo-model, I3RC-Examples/Data; the "
    "consensus: https://i3rc.gsfc.nasa.gov, or the folders i3rc/caseN/consensus_results of "
    "https://github.com/tamarloeub/MitsubaGradient";

/* 128 x 128 numbers take a quarter of a megabyte. */
static const size_t limit_bytes = (size_t)16 << 20;

static enum neph_status parse(const struct neph_i3rc_file *file, struct neph_text_numbers *numbers,
                              double *values, struct neph_diag *diag)
{
    for (int i = 0; i < file->values; i++) {
        enum neph_status status = neph_text_next_word(numbers, diag);
        if (!status && !numbers->word[0])
            status = neph_fail(diag, NEPH_ERR_INPUT, "the file ends after %d of %d values", i,
                               file->values);
        if (!status)
            status = neph_text_to_number(numbers, file->what, file->minimum, file->maximum,
                                         &values[i], diag);
        if (status)
            return status;
    }
    const enum neph_status status = neph_text_next_word(numbers, diag);
    return !status && numbers->word[0]
               ? neph_fail(diag, NEPH_ERR_INPUT, "more than %d values", file->values)
               : status;
}

enum neph_status neph_i3rc_file_read(const char *folder, const struct neph_i3rc_file *file,
                                     double **values, struct neph_diag *diag)
{
    const struct neph_path path = neph_path_in(folder, file->name);
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = neph_file_read(path.text, limit_bytes, &text, &size, diag);
    if (status)
        return status;
    struct neph_text_numbers numbers = {.file = fmemopen(text, size, "r")};
    double *made = calloc((size_t)file->values, sizeof(*made));
    if (!made || !numbers.file)
        status = neph_fail_memory(diag);
    else if ((status = parse(file, &numbers, made, diag)) && diag)
        neph_locate(diag, path.text, numbers.line, numbers.column);
    if (numbers.file)
        fclose(numbers.file);
    free(text);
    if (status)
        free(made);
    else
        *values = made;
    return status;
}

enum neph_status neph_i3rc_consensus_read(const char *folder, int case_number, int experiment,
                                          const char *quantity, int columns, double **values,
                                          struct neph_diag *diag)
{
    static const char *const prefixes[] = {"", "I3RC_cons_res_"};
    *values = NULL;
    for (size_t i = 0; i < sizeof(prefixes) / sizeof(prefixes[0]); i++) {
        const struct neph_path name = neph_path_format("%scase%d_exp%d_%s.txt", prefixes[i],
                                                       case_number, experiment, quantity);
        /* H may be of either sign. */
        const struct neph_i3rc_file file = {name.text, "a flux over the sunlight", columns, -100.0,
                                            100.0};
        const enum neph_status status = neph_i3rc_file_read(folder, &file, values, diag);
        if (status != NEPH_ERR_NOT_FOUND)
            return status;
    }
    return NEPH_OK;
}
