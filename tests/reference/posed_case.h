#pragma once

#include <cstddef>
#include <vector>

#include "core/isa.h"
#include "scene/preparation/traits.h"
#include "tests/reference/truth_case.h"

namespace render2mpeg::reference {

/// Pixels of a case's picture, each way.
inline constexpr int case_side = 16;

/// A case, posed at its first instant.
struct Posed {
    explicit Posed(const TruthCase& c)
        : film(c.scene.build()),
          plan(renderer::make_plan(scene::traits_of(film), {})),
          world(test::snapshot(film, 0, case_side, case_side)),
          posed_scene(film, core::detect_isa(), plan) {
        posed_scene.pose(world);
    }
    Posed(const Posed&) = delete;
    Posed& operator=(const Posed&) = delete;

    scene::Animation film;
    renderer::Plan plan;
    scene::Snapshot world;
    renderer::PosedScene posed_scene;
};

/// The ray through a pixel's centre.
inline scene::Ray ray_of(const scene::Camera& camera, int x, int y) {
    return camera.ray_through({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
}

inline glm::dvec3 closed_form_of(const TruthCase& c, const scene::Camera& camera, int x, int y) {
    const scene::Ray ray = ray_of(camera, x, y);
    return c.closed_form(glm::dvec3(ray.origin), glm::normalize(glm::dvec3(ray.direction)));
}

inline glm::dvec3 closed_form_mean(const TruthCase& c, const scene::Camera& camera) {
    glm::dvec3 sum(0);
    for (int y = 0; y < case_side; ++y)
        for (int x = 0; x < case_side; ++x) sum += closed_form_of(c, camera, x, y);
    return sum / (1.0 * case_side * case_side);
}

/// Of estimates that do not depend on one another.
inline Estimate mean_of(const std::vector<Estimate>& parts) {
    glm::dvec3 sum(0), squares(0);
    for (const Estimate& e : parts) {
        sum += e.mean;
        squares += e.error * e.error;
    }
    const auto count = static_cast<double>(parts.size());
    return {sum / count, glm::sqrt(squares) / count};
}

}  // namespace render2mpeg::reference
