/* SPDX-License-Identifier: MIT */
#include "harness/engines/cycles_phase.h"

#include "scenes/media.h"
#include "scenes/phase_same.h"

#include <math.h>
#include <stddef.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_PHASE_KIND_COUNT == 10, "a new kind");
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

enum { INPUTS_MAX = 2 };

enum share { WHOLE, FIRST, SECOND };

/* A number of a node: a parameter of struct neph_phase, or a constant. */
struct input {
    const char *name;
    size_t offset; /* 0: the constant */
    double constant;
    double maximum; /* Blender clamps larger values silently; 0: as ours */
};

static const char henyey_greenstein[] = "HENYEY_GREENSTEIN";

/* The nodes Volume Scatter of each kind: property `phase`, share of the scattering, inputs.
 * Cornette and Shanks have Draine's phase function with alpha 1. Blender's "Mie" is Jendersie and
 * d'Eon's; its parameters are those of scenes/ from 5 um on. */
#define AT(member) offsetof(struct neph_phase, member)
static const struct lobe {
    enum neph_phase_kind kind;
    const char *word;
    enum share share;
    struct input inputs[INPUTS_MAX];
} all_lobes[] = {
    {NEPH_PHASE_ISOTROPIC, henyey_greenstein, WHOLE, {{"Anisotropy", AT(g)}}},
    {NEPH_PHASE_HENYEY_GREENSTEIN, henyey_greenstein, WHOLE, {{"Anisotropy", AT(g)}}},
    {NEPH_PHASE_RAYLEIGH, "RAYLEIGH", WHOLE, {{NULL}}},
    {NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN, henyey_greenstein, FIRST, {{"Anisotropy", AT(g)}}},
    {NEPH_PHASE_DOUBLE_HENYEY_GREENSTEIN,
     henyey_greenstein,
     SECOND,
     {{"Anisotropy", AT(second_g)}}},
    {NEPH_PHASE_CORNETTE_SHANKS, "DRAINE", WHOLE, {{"Anisotropy", AT(g)}, {"Alpha", 0, 1.0}}},
    {NEPH_PHASE_DRAINE,
     "DRAINE",
     WHOLE,
     {{"Anisotropy", AT(g)}, {"Alpha", AT(draine_alpha), .maximum = 500.0}}},
    {NEPH_PHASE_JENDERSIE_DEON, "MIE", WHOLE, {{"Diameter", AT(droplet_diameter_um)}}},
};
#undef AT
enum { LOBES = sizeof(all_lobes) / sizeof(all_lobes[0]) };

static double find_value(const struct neph_phase *phase, const struct input *input)
{
    return input->offset ? *(const double *)((const char *)phase + input->offset) : input->constant;
}

static double find_share(const struct neph_phase *phase, enum share share)
{
    return share == WHOLE ? 1.0 : share == FIRST ? phase->first_share : 1.0 - phase->first_share;
}

/* The first input above its maximum; NULL: none. */
static const struct input *find_excess(const struct neph_phase *phase, const struct lobe *lobe)
{
    for (const struct input *input = lobe->inputs; input < lobe->inputs + INPUTS_MAX; input++)
        if (input->maximum > 0.0 && find_value(phase, input) > input->maximum)
            return input;
    return NULL;
}

static enum neph_status check_phase(const struct neph_phase *phase, struct neph_diag *diag)
{
    bool is_known = false;
    for (const struct lobe *lobe = all_lobes; lobe < all_lobes + LOBES; lobe++) {
        const struct input *excess = lobe->kind == phase->kind ? find_excess(phase, lobe) : NULL;
        if (excess)
            return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                             "phase function %s with %s %g: Cycles takes 0 to %g",
                             neph_phase_words[phase->kind], excess->name, find_value(phase, excess),
                             excess->maximum);
        is_known |= lobe->kind == phase->kind;
    }
    return is_known ? NEPH_OK
                    : neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                                "phase function %s, which Cycles does not have; `neph study "
                                "phase` fits those that it has to droplets",
                                neph_phase_words[phase->kind]);
}

static json_t *lobe_json(const struct neph_phase *phase, const struct lobe *lobe)
{
    json_t *inputs = json_object();
    for (int i = 0; i < INPUTS_MAX && lobe->inputs[i].name; i++)
        neph_json_set(&inputs, lobe->inputs[i].name,
                      json_real(find_value(phase, &lobe->inputs[i])));
    return json_pack("{s:s, s:f, s:o}", "phase", lobe->word, "share",
                     find_share(phase, lobe->share), "inputs", inputs);
}

json_t *neph_cycles_lobes(const struct neph_phase *phase)
{
    json_t *list = json_array();
    for (const struct lobe *lobe = all_lobes; lobe < all_lobes + LOBES; lobe++)
        if (lobe->kind == phase->kind)
            neph_json_add(&list, lobe_json(phase, lobe));
    return list;
}

static double find_brightest(struct neph_rgb color)
{
    return fmax(color.r, fmax(color.g, color.b));
}

bool neph_cycles_has_extinction(const struct neph_medium *medium)
{
    if (!neph_medium_is_fog(medium))
        return medium->extinction_per_m > 0.0 && find_brightest(medium->extinction_color) > 0.0;
    for (int i = 0; i < medium->layer_count; i++)
        if (medium->layers[i].extinction_per_m > 0.0)
            return find_brightest(medium->extinction_color) > 0.0;
    return false;
}

static bool scatters(const struct neph_medium *medium)
{
    return find_brightest(medium->albedo) > 0.0 && neph_cycles_has_extinction(medium);
}

/* One Henyey-Greenstein, which every Blender has. */
static bool is_simple(const struct neph_phase *phase)
{
    bool is = false;
    for (const struct lobe *lobe = all_lobes; lobe < all_lobes + LOBES; lobe++)
        is |= lobe->kind == phase->kind && lobe->word == henyey_greenstein && lobe->share == WHOLE;
    return is;
}

static bool is_same(const struct neph_phase *a, const struct neph_phase *b)
{
    return is_simple(a) && is_simple(b) ? a->g == b->g : neph_phase_is_same(a, b);
}

static bool boxes_overlap(const struct neph_bounds *a, const struct neph_bounds *b)
{
    return a->min_m.x < b->max_m.x && b->min_m.x < a->max_m.x && a->min_m.y < b->max_m.y &&
           b->min_m.y < a->max_m.y && a->min_m.z < b->max_m.z && b->min_m.z < a->max_m.z;
}

static enum neph_status fail_mixture(struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                     "media of different phase functions in one place (Cycles 3.4 adds the "
                     "functions up without weights, later ones with weights that ignore the "
                     "albedos' colours)");
}

enum neph_status neph_cycles_check_phases(const struct neph_scene *scene,
                                          const struct neph_bounds *containers,
                                          struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < scene->medium_count && !status; i++) {
        const struct neph_medium *medium = &scene->media[i];
        if (!scatters(medium))
            continue;
        status = check_phase(&medium->phase, diag);
        for (int j = 0; j < i && !status; j++)
            if (scatters(&scene->media[j]) && !is_same(&medium->phase, &scene->media[j].phase) &&
                boxes_overlap(&containers[i], &containers[j]))
                status = fail_mixture(diag);
    }
    return status;
}

bool neph_cycles_needs_phases(const struct neph_scene *scene)
{
    bool needs = false;
    for (int i = 0; i < scene->medium_count; i++)
        needs |= scatters(&scene->media[i]) && !is_simple(&scene->media[i].phase);
    return needs && scene->scattering != NEPH_SCATTERING_NONE;
}
