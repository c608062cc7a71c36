// plugin.cc -- a plugin in C++: an equation of state whose life is that of an object. An exception
// must not cross the border: what may throw is caught and becomes a status.
#include <sph/plugin.h>

#include <new>
#include <vector>

namespace
{

class Gas
{
public:
    explicit Gas(double cs) : square(1, cs * cs) {}
    sph_status run(const sph_batch &b) const
    {
        const double *rho = static_cast<const double *>(b.dst[0].data);
        double *p = static_cast<double *>(b.dst[1].data);
        double *cs = static_cast<double *>(b.dst[2].data);
        for (uint64_t i = b.first; i < b.first + b.count; i++) {
            p[i] = square.at(0) * rho[i];
            cs[i] = b.param[0];
        }
        return SPH_OK;
    }

private:
    std::vector<double> square; // on the heap, to have something to destroy
};

sph_status create(const sph_host *host, const sph_config *config, uint32_t, void **state)
{
    try {
        *state = new Gas(host->param(config, "cs"));
        return SPH_OK;
    } catch (const std::bad_alloc &) {
        return host->fail(host, SPH_E_NOMEM, "no memory for the gas");
    }
}

void destroy(const sph_host *, void *state)
{
    delete static_cast<Gas *>(state);
}

sph_status run(const sph_batch *b)
{
    return static_cast<const Gas *>(b->state)->run(*b);
}

const sph_param params[] = {
    {"cs", "m/s", "speed of sound", 1.0, 0.0, 1e9, nullptr, SPH_PARAM_NUMBER, 0}};
const sph_prop props[] = {
    {"rho", "kg/m^d", "density", SPH_SCALAR, SPH_DST_READ, 0.0},
    {"p", "J/m^d", "pressure", SPH_SCALAR, SPH_DST_WRITE, 0.0},
    {"cs", "m/s", "speed of sound", SPH_SCALAR, SPH_DST_WRITE, 0.0},
};
const sph_item item = {sizeof(sph_item), SPH_ALL_DIMS,     "cold-gas",     "p = cs^2 rho",
                       "",               SPH_LIST(params), SPH_LIST(props)};
const sph_life life = {sizeof(sph_life), 0, create, destroy};
const sph_eos eos = {sizeof(sph_eos), 0, &item, &life, run, nullptr, SPH_NO_LIST, nullptr};

sph_status init(const sph_host *host)
{
    return host->register_item(host, SPH_KIND_EOS, &eos);
}

} // namespace

SPH_PLUGIN("cold-gas", "1.0", "BSD-3-Clause", "an isothermal gas, in C++", init, nullptr)
