/* shapes.c -- see shapes.h. */
#include "shapes.h"

#include <sph/plugin.h>

#define M(type, kind, member)                                                                      \
    {                                                                                              \
        kind, offsetof(type, member), NULL                                                         \
    }
#define TO(type, kind, member, shape)                                                              \
    {                                                                                              \
        kind, offsetof(type, member), &(shape)                                                     \
    }

const struct shape shape_param = {sizeof(sph_param),
                                  {M(sph_param, TEXT, name), M(sph_param, TEXT, unit),
                                   M(sph_param, TEXT, doc), M(sph_param, REAL, def),
                                   M(sph_param, REAL, min), M(sph_param, REAL, max),
                                   M(sph_param, TEXT, choices), M(sph_param, WORD, type)}};
const struct shape shape_prop = {sizeof(sph_prop),
                                 {M(sph_prop, TEXT, name), M(sph_prop, TEXT, unit),
                                  M(sph_prop, TEXT, doc), M(sph_prop, WORD, type),
                                  M(sph_prop, WORD, access), M(sph_prop, REAL, start)}};
const struct shape shape_rate = {
    sizeof(sph_rate),
    {M(sph_rate, TEXT, property), M(sph_rate, TEXT, rate), M(sph_rate, WORD, kind)}};
const struct shape shape_reduction = {sizeof(sph_reduction),
                                      {M(sph_reduction, TEXT, name),
                                       M(sph_reduction, TEXT, property), M(sph_reduction, WORD, op),
                                       M(sph_reduction, WORD, use)}};
const struct shape shape_step = {sizeof(sph_step),
                                 {M(sph_step, TEXT, at), M(sph_step, TEXT, kind),
                                  M(sph_step, TEXT, name), M(sph_step, TEXT, after),
                                  M(sph_step, TEXT, before), M(sph_step, WORD, on)}};
const struct shape shape_term = {sizeof(sph_kernel_term),
                                 {M(sph_kernel_term, REAL, coef), M(sph_kernel_term, REAL, knot),
                                  M(sph_kernel_term, WORD, power)}};
const struct shape shape_item = {
    sizeof(sph_item),
    {M(sph_item, SIZE, size), M(sph_item, WORD, dims), M(sph_item, TEXT, name),
     M(sph_item, TEXT, doc), M(sph_item, TEXT, source), TO(sph_item, LIST, params, shape_param),
     TO(sph_item, LIST, props, shape_prop)}};
const struct shape shape_life = {
    sizeof(sph_life),
    {M(sph_life, SIZE, size), M(sph_life, CODE, create), M(sph_life, CODE, destroy)}};
const struct shape shape_value = {sizeof(sph_device_value),
                                  {M(sph_device_value, TEXT, name),
                                   M(sph_device_value, WORD, index),
                                   M(sph_device_value, WORD, type)}};
const struct shape shape_device = {
    sizeof(sph_device_body),
    {M(sph_device_body, SIZE, size), M(sph_device_body, WORD, reach),
     M(sph_device_body, WORD, self), M(sph_device_body, TEXT, text), M(sph_device_body, TEXT, file),
     M(sph_device_body, TEXT, prelude), M(sph_device_body, TEXT, prelude_file),
     TO(sph_device_body, LIST, i, shape_value), TO(sph_device_body, LIST, j, shape_value),
     TO(sph_device_body, LIST, sum, shape_value), TO(sph_device_body, LIST, min, shape_value),
     TO(sph_device_body, LIST, max, shape_value), TO(sph_device_body, LIST, param, shape_value)}};
static const struct shape shape_sentence = {sizeof(const char *), {{TEXT, 0, NULL}}};
const struct shape shape_point = {
    sizeof(sph_device_point),
    {M(sph_device_point, SIZE, size), M(sph_device_point, WORD, h), M(sph_device_point, TEXT, text),
     M(sph_device_point, TEXT, file), M(sph_device_point, TEXT, prelude),
     M(sph_device_point, TEXT, prelude_file), TO(sph_device_point, LIST, in, shape_value),
     TO(sph_device_point, LIST, out, shape_value), TO(sph_device_point, LIST, inout, shape_value),
     TO(sph_device_point, LIST, param, shape_value), TO(sph_device_point, LIST, state, shape_value),
     TO(sph_device_point, LIST, fail, shape_sentence)}};
const struct shape shape_function = {
    sizeof(sph_function),
    {M(sph_function, SIZE, size), M(sph_function, WORD, shape),
     TO(sph_function, LINK, item, shape_item), TO(sph_function, LINK, life, shape_life),
     M(sph_function, CODE, before), M(sph_function, CODE, run), M(sph_function, CODE, after),
     M(sph_function, WORD, reach), M(sph_function, WORD, max_sweeps),
     M(sph_function, TEXT, unfinished), M(sph_function, REAL, reach_scale),
     TO(sph_function, LIST, rates, shape_rate), TO(sph_function, LIST, reductions, shape_reduction),
     TO(sph_function, LINK, device, shape_device), M(sph_function, CODE, prepare),
     TO(sph_function, LINK, device_run, shape_point),
     TO(sph_function, LINK, device_before, shape_point),
     TO(sph_function, LINK, device_after, shape_point)}};
const struct shape shape_eos = {
    sizeof(sph_eos),
    {M(sph_eos, SIZE, size), TO(sph_eos, LINK, item, shape_item),
     TO(sph_eos, LINK, life, shape_life), M(sph_eos, CODE, run), M(sph_eos, CODE, inverse),
     TO(sph_eos, LIST, inverse_props, shape_prop), TO(sph_eos, LINK, device, shape_point)}};
const struct shape shape_boundary = {sizeof(sph_boundary),
                                     {M(sph_boundary, SIZE, size),
                                      TO(sph_boundary, LINK, item, shape_item),
                                      TO(sph_boundary, LIST, steps, shape_step)}};
const struct shape shape_kernel = {
    sizeof(sph_kernel),
    {M(sph_kernel, SIZE, size), TO(sph_kernel, LINK, item, shape_item),
     M(sph_kernel, REAL, support), M(sph_kernel, REAL, norm[1]), M(sph_kernel, REAL, norm[2]),
     M(sph_kernel, REAL, norm[3]), TO(sph_kernel, LIST, terms[1], shape_term),
     TO(sph_kernel, LIST, terms[2], shape_term), TO(sph_kernel, LIST, terms[3], shape_term),
     M(sph_kernel, CODE, value), M(sph_kernel, CODE, slope)}};
const struct shape shape_scheme = {
    sizeof(sph_scheme),
    {M(sph_scheme, SIZE, size), TO(sph_scheme, LINK, item, shape_item), M(sph_scheme, TEXT, kernel),
     M(sph_scheme, TEXT, integrator), M(sph_scheme, REAL, cfl),
     TO(sph_scheme, LIST, steps, shape_step), TO(sph_scheme, LIST, rates, shape_rate)}};
const struct shape shape_exact = {sizeof(sph_exact),
                                  {M(sph_exact, SIZE, size), TO(sph_exact, LINK, item, shape_item),
                                   TO(sph_exact, LINK, life, shape_life), M(sph_exact, CODE, run)}};
const struct shape shape_plugin = {sizeof(sph_plugin),
                                   {M(sph_plugin, SIZE, size), M(sph_plugin, WORD, magic),
                                    M(sph_plugin, WORD, abi_major), M(sph_plugin, WORD, abi_minor),
                                    M(sph_plugin, TEXT, name), M(sph_plugin, TEXT, version),
                                    M(sph_plugin, TEXT, license), M(sph_plugin, TEXT, doc),
                                    M(sph_plugin, CODE, init), M(sph_plugin, CODE, fini)}};
const struct shape shape_population = {
    sizeof(sph_population),
    {M(sph_population, SIZE, size), M(sph_population, TEXT, remove),
     M(sph_population, TEXT, create), M(sph_population, CODE, born),
     TO(sph_population, LIST, born_props, shape_prop)}};
const struct shape shape_state = {sizeof(sph_state),
                                  {M(sph_state, SIZE, size), M(sph_state, WORD, format),
                                   M(sph_state, CODE, save), M(sph_state, CODE, restore)}};
