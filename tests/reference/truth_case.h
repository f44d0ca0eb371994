#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "renderer/renderer.h"
#include "tests/reference/path_tracer.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::reference {

/// Radiance along a ray, where it is known in closed form.
using ClosedForm = std::function<glm::dvec3(glm::dvec3 origin, glm::dvec3 direction)>;

/// How far the renderer's picture may be off, as a share of the truth: the whole picture's mean, and that of each patch
/// of 4 x 4 pixels.
struct Allowed {
    double whole = 0.005, patch = 0.02;
};

/// A small scene that shows one material or lamp, or one way of light, and how it is to be judged.
struct TruthCase {
    test::SceneBuilder scene;
    int vpls = 0;              ///< of the renderer; 0: direct light alone, and paths with no bounce
    int direct_points = 1024;  ///< likewise
    int specular_depth = 6;    ///< likewise
    bool caustics = false;     ///< of both; lamps without size throw none that paths find
    Finding finding = Finding::by_connection;
    std::uint64_t paths = 1536;  ///< of the path tracer, per pixel
    Allowed allowed;
    ClosedForm closed_form;            ///< empty: none is known
    double closed_form_pixel = 0.002;  ///< how far each pixel may be off it
};

using MakeCase = TruthCase (*)();
struct NamedCase {
    const char* name;
    MakeCase make;
};

/// Each kind of lamp on a matt floor, alone and with a block before it.
std::vector<NamedCase> lamp_cases();
/// Each kind of material under sun, sky and a panel.
std::vector<NamedCase> material_cases();
/// What is seen in mirrors, through glass and layers.
std::vector<NamedCase> specular_cases();
/// Closed boxes.
std::vector<NamedCase> furnace_cases();
/// Indirect light; the renderer takes seconds for each.
std::vector<NamedCase> indirect_cases();

}  // namespace render2mpeg::reference
