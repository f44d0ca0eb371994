#include <gtest/gtest.h>

#include "core/fog.h"
#include "tests/hard_cases/hard_case.h"

namespace render2mpeg::test {
namespace {

/// A white floor of this size under a lamp and a grey sky, in fog through which one sees so far.
SceneBuilder foggy_floor(float size, float visibility, float falloff = 0) {
    SceneBuilder b;
    b.add_quad({-size, 0, size}, {2 * size, 0, 0}, {0, 0, -2 * size}, b.add_material(glm::vec3(0.9f)));
    b.add_point_light({0, size, 0}, size * size);
    b.film().sky.color = glm::vec3(0.5f);
    b.film().fog.visibility = visibility;
    b.film().fog.falloff = falloff;
    b.film().fog.color = glm::vec3(1);
    b.add_camera({0, 0.5f * size, 2 * size}, {0, 0, 0});
    return b;
}

void expect_light(const Lit& film) {
    EXPECT_GT(film.mean(), 0.01);
    EXPECT_LT(film.mean(), 10.0);
}

}  // namespace

std::vector<HardCase> air_cases() {
    return {
        {"fog as thin as there is", "shares of light that round to nothing", "the film without fog, nearly",
         [] { return foggy_floor(2, core::most_visibility); },
         [](const Lit& film) { expect_like(film, foggy_floor(2, 1e6f), 0.03); }},
        {"fog as dense as there is", "optical depths of thousands in one cell", "finite, and a whole film",
         [] { return foggy_floor(2, core::least_visibility); }},
        {"fog about nothing", "a box without extent", "finite, and a whole film",
         [] {
             SceneBuilder b;
             b.add_point_light({0, 0, 0}, 1);
             b.film().sky.color = glm::vec3(0.5f);
             b.film().fog.visibility = 3;
             b.add_camera({0, 0, 3}, {0, 0, 0});
             return b;
         }},
        {"fog over a floor of a micrometre", "cells whose volume rounds to 0", "light, and a whole film",
         [] { return foggy_floor(1e-6f, 3e-6f); }, expect_light},
        {"fog over a floor of a million", "boxes whose volume is huge", "light, and a whole film",
         [] { return foggy_floor(1e6f, 3e6f); }, expect_light},
        {"fog that thins out within a millimetre", "layers thinner than cells", "finite, and a whole film",
         [] { return foggy_floor(2, 3, 1e-3f); }},
        {"a lamp of 1e12 in fog", "the nearest corner of a lattice is as bright as the lamp",
         "finite, and a whole film",
         [] {
             SceneBuilder b = foggy_floor(2, 3);
             b.add_point_light({0, 1, 0}, 1e12f);
             return b;
         }},
    };
}

}  // namespace render2mpeg::test
