/* SPDX-License-Identifier: MIT */
#include "scenes/quadrature.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

/* The first evaluations of this many pieces are kept; further pieces are evaluated twice. */
enum { NODE_COUNT = 11, DEPTH_MAX = 20, KEPT_COUNT = 256 };

/* The 21-point Kronrod rule: non-negative nodes, descending; odd places are the Gauss nodes. */
static const double nodes[NODE_COUNT] = {
    0.995657163025808080735527280689003, 0.973906528517171720077964012084452,
    0.930157491355708226001207180059508, 0.865063366688984510732096688423493,
    0.780817726586416897063717578345042, 0.679409568299024406234327365114874,
    0.562757134668604683339000099272694, 0.433395394129247190799265943165784,
    0.294392862701460198131126603103866, 0.148874338981631210884826001129720,
    0.000000000000000000000000000000000};
static const double kronrod_weights[NODE_COUNT] = {
    0.011694638867371874278064396062192, 0.032558162307964727478818972459390,
    0.054755896574351996031381300244580, 0.075039674810919952767043140916190,
    0.093125454583697605535065465083366, 0.109387158802297641899210590325805,
    0.123491976262065851077958109585166, 0.134709217311473325928054001771707,
    0.142775938577060080797094273138717, 0.147739104901338491374841515972068,
    0.149445554002916905664936468389821};
static const double gauss_weights[NODE_COUNT / 2] = {
    0.066671344308688137593568809893332, 0.149451349150580593145863396957658,
    0.219086362515982043995534934228163, 0.269266719309996355091226921569469,
    0.295524224714752870173815619188769};

struct piece {
    double kronrod[3];
    double error; /* of the worst channel */
};

/* The integral to compute, and its tolerance. */
struct task {
    neph_integrand *integrand;
    void *context;
    bool rough;
    double error_max; /* of a piece; from the whole integral */
};

static struct piece evaluate(const struct task *task, double a, double b)
{
    const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
    double kronrod[3] = {0}, gauss[3] = {0};
    for (int i = 0; i < NODE_COUNT; i++) {
        const bool is_middle = i == NODE_COUNT - 1;
        for (int side = is_middle ? 1 : -1; side <= 1; side += 2) {
            double value[3];
            task->integrand(middle + side * half * nodes[i], task->context, value);
            for (int c = 0; c < 3; c++) {
                kronrod[c] += kronrod_weights[i] * value[c];
                if (i % 2 == 1)
                    gauss[c] += gauss_weights[i / 2] * value[c];
            }
        }
    }
    struct piece piece = {.error = 0.0};
    for (int c = 0; c < 3; c++) {
        piece.kronrod[c] = half * kronrod[c];
        /* The pair's difference is the error of the 10-point rule; QUADPACK's power of 3/2 is an
         * empirical estimate for the 21-point rule. */
        const double size = fabs(piece.kronrod[c]);
        const double difference = fabs(half * (kronrod[c] - gauss[c]));
        double error = difference;
        if (!task->rough && size > 0.0 && difference > 0.0)
            error = size * fmin(1.0, pow(200.0 * difference / size, 1.5));
        piece.error = fmax(piece.error, error);
    }
    return piece;
}

/* Bisects until the error is below the limit, and sums the results of the 21-point rule. */
static double refine(const struct task *task, double a, double b, struct piece whole, int depth,
                     double result[3])
{
    if (whole.error <= task->error_max || depth == DEPTH_MAX) {
        for (int c = 0; c < 3; c++)
            result[c] += whole.kronrod[c];
        return whole.error;
    }
    const double middle = 0.5 * (a + b);
    const struct piece left = evaluate(task, a, middle);
    const struct piece right = evaluate(task, middle, b);
    return refine(task, a, middle, left, depth + 1, result) +
           refine(task, middle, b, right, depth + 1, result);
}

static double integrate(struct task *task, const struct neph_interval *pieces, int piece_count,
                        double tolerance, double result[3])
{
    struct piece first[KEPT_COUNT];
    double scale = DBL_MIN;
    for (int i = 0; i < piece_count; i++) {
        const struct piece piece = evaluate(task, pieces[i].low, pieces[i].high);
        scale += fmax(fabs(piece.kronrod[0]), fmax(fabs(piece.kronrod[1]), fabs(piece.kronrod[2])));
        if (i < KEPT_COUNT)
            first[i] = piece;
    }
    task->error_max = tolerance * scale;
    double error = 0.0;
    result[0] = result[1] = result[2] = 0.0;
    for (int i = 0; i < piece_count; i++) {
        const double low = pieces[i].low, high = pieces[i].high;
        const struct piece piece = i < KEPT_COUNT ? first[i] : evaluate(task, low, high);
        error += refine(task, low, high, piece, 0, result);
    }
    return error;
}

double neph_integrate(neph_integrand *integrand, void *context, const struct neph_interval *pieces,
                      int piece_count, double result[3])
{
    struct task task = {integrand, context, false, 0.0};
    return integrate(&task, pieces, piece_count, 1e-13, result);
}

double neph_integrate_rough(neph_integrand *integrand, void *context,
                            const struct neph_interval *pieces, int piece_count, double tolerance,
                            double result[3])
{
    struct task task = {integrand, context, true, 0.0};
    return integrate(&task, pieces, piece_count, tolerance, result);
}

double neph_gauss(double (*integrand)(double x, const void *context), const void *context, double a,
                  double b)
{
    static const struct {
        double node, weight;
    } rule[] = {
        {0.993128599185094924786122388471320, 0.0176140071391521183118619623518528},
        {0.963971927277913791267666131197277, 0.0406014298003869413310399522749321},
        {0.912234428251325905867752441203298, 0.0626720483341090635695065351870416},
        {0.839116971822218823394529061701521, 0.0832767415767047487247581432220462},
        {0.746331906460150792614305070355642, 0.101930119817240435036750135480350},
        {0.636053680726515025452836696226286, 0.118194531961518417312377377711382},
        {0.510867001950827098004364050955251, 0.131688638449176626898494499748163},
        {0.373706088715419560672548177024927, 0.142096109318382051329298325067165},
        {0.227785851141645078080496195368575, 0.149172986472603746787828737001969},
        {0.0765265211334973337546404093988382, 0.152753387130725850698084331955098},
    };
    const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
    double sum = 0.0;
    for (size_t i = 0; i < sizeof(rule) / sizeof(rule[0]); i++)
        sum += rule[i].weight * (integrand(middle - half * rule[i].node, context) +
                                 integrand(middle + half * rule[i].node, context));
    return half * sum;
}
