/* wrong_eos.c -- equations of state, each with one fault, and three without. */
#include "wrong.h"

#include <math.h>

static const sph_prop props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN},
    {"u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_READ, NAN},
    {"p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0},
    {"cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0},
};
static const sph_prop inverse_props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN},
    {"p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_READ, NAN},
    {"u", "J/kg", "specific internal energy", SPH_SCALAR, SPH_DST_WRITE, 0},
};
static const sph_prop cold_props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, NAN},
    {"p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0},
    {"cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0},
};
static const sph_param cold_params[] = {
    {"rho0", "kg/m^d", "density at rest", 1000, 1e-300, 1e300, NULL, SPH_PARAM_NUMBER, 0},
    {"c0", "m/s", "speed of sound at rest", NAN, 1e-300, 1e300, NULL, SPH_PARAM_NUMBER, 0},
};

/* p = (g - 1) rho u - g stiff; the speed is `wrong` times what it should be. */
static sph_status gas(const sph_batch *b, double g, double stiff, double wrong)
{
    EACH(i, b)
    {
        const double rho = plane(&b->dst[0])[i];
        const double p = (g - 1) * rho * plane(&b->dst[1])[i] - g * stiff;
        plane(&b->dst[2])[i] = p;
        plane(&b->dst[3])[i] = wrong * sqrt(g * (p + stiff) / rho);
    }
    return SPH_OK;
}
static sph_status gas_inverse(const sph_batch *b, double g, double stiff, double wrong)
{
    EACH(i, b)
    plane(&b->dst[2])[i] =
        wrong * (plane(&b->dst[1])[i] + g * stiff) / ((g - 1) * plane(&b->dst[0])[i]);
    return SPH_OK;
}

static sph_status right_run(const sph_batch *b)
{
    return gas(b, 1.4, 0, 1);
}
static sph_status right_inverse(const sph_batch *b)
{
    return gas_inverse(b, 1.4, 0, 1);
}
static sph_status stiff_run(const sph_batch *b)
{
    return gas(b, 4.4, 6e8, 1);
}
static sph_status stiff_inverse(const sph_batch *b)
{
    return gas_inverse(b, 4.4, 6e8, 1);
}
static sph_status sound_run(const sph_batch *b)
{
    return gas(b, 1.4, 0, 1.01);
}
static sph_status wrong_inverse(const sph_batch *b)
{
    return gas_inverse(b, 1.4, 0, 1.0001);
}

/* p = rho0 c0^2 / 7 ((rho / rho0)^7 - 1); `power` should be 6. */
static sph_status cold(const sph_batch *b, double power)
{
    const double rho0 = b->param[0], c0 = b->param[1];

    EACH(i, b)
    {
        const double s = plane(&b->dst[0])[i] / rho0;
        plane(&b->dst[1])[i] = rho0 * c0 * c0 / 7 * (pow(s, 7) - 1);
        plane(&b->dst[2])[i] = c0 * sqrt(pow(s, power));
    }
    return SPH_OK;
}
static sph_status cold_run(const sph_batch *b)
{
    return cold(b, 6);
}
static sph_status cold_sound_run(const sph_batch *b)
{
    return cold(b, 7);
}
static sph_status nan_run(const sph_batch *b)
{
    EACH(i, b)
    plane(&b->dst[2])[i] = plane(&b->dst[3])[i] = sqrt(-1 - plane(&b->dst[1])[i]);
    return SPH_OK;
}

#define GAS(variable, name, run_, inverse_)                                                        \
    ITEM(variable##_item, name, props);                                                            \
    static const sph_eos variable = {.size = SIZE(sph_eos),                                        \
                                     .item = &variable##_item,                                     \
                                     .run = run_,                                                  \
                                     .inverse = inverse_,                                          \
                                     .inverse_props = SPH_LIST(inverse_props)}
#define COLD(variable, name_, run_)                                                                \
    static const sph_item variable##_item = {.size = SIZE(sph_item),                               \
                                             .dims = SPH_ALL_DIMS,                                 \
                                             .name = name_,                                        \
                                             .doc = "a liquid",                                    \
                                             .source = "nobody",                                   \
                                             .params = SPH_LIST(cold_params),                      \
                                             .props = SPH_LIST(cold_props)};                       \
    static const sph_eos variable = {.size = SIZE(sph_eos), .item = &variable##_item, .run = run_}

GAS(right, "right-gas", right_run, right_inverse);
GAS(stiff, "stiff-gas", stiff_run, stiff_inverse);
GAS(sound, "wrong-sound", sound_run, right_inverse);
GAS(back, "wrong-inverse", right_run, wrong_inverse);
COLD(liquid, "right-liquid", cold_run);
COLD(liquid_sound, "wrong-liquid", cold_sound_run);
ITEM(never_item, "never-a-number", props);
static const sph_eos never = {.size = SIZE(sph_eos), .item = &never_item, .run = nan_run};

static sph_status init(const sph_host *host)
{
    static const sph_eos *const all[] = {&right,  &stiff,        &sound, &back,
                                         &liquid, &liquid_sound, &never};

    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const sph_status status = host->register_item(host, SPH_KIND_EOS, all[i]);
        if (status != SPH_OK)
            return status;
    }
    return SPH_OK;
}

SPH_PLUGIN("wrong-eos", "1.0", "BSD-3-Clause", "equations of state with a fault each", init, NULL)
