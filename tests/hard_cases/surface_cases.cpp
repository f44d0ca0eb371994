#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/hard_cases/hard_case.h"

namespace render2mpeg::test {
namespace {

void expect_same(const Lit& film, const SceneBuilder& other) {
    const HardCase plain;
    const Lit expected = lit(plain, other, film.way);
    for (std::size_t i = 0; i < expected.frames.front().combined.size(); ++i)
        ASSERT_EQ(film.frames.front().combined.values()[i], expected.frames.front().combined.values()[i]) << i;
}

/// A lit floor with a ball and a block, `scale` times as large and moved by `offset`; light falls off as the square.
SceneBuilder table(double scale = 1, glm::dvec3 offset = {0, 0, 0}) {
    SceneBuilder b;
    const int white = b.add_material(glm::vec3(0.5f)), red = b.add_material({0.6f, 0.2f, 0.1f});
    const auto add = [&](scene::Mesh mesh, int material) {
        b.add_object(b.add_mesh(std::move(mesh)), material, offset, {1, 0, 0, 0}, glm::dvec3(scale));
    };
    add(SceneBuilder::quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), white);
    add(SceneBuilder::quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}), red);
    add(SceneBuilder::box({-1, 0, -1}, {0, 1, 0}, false), white);
    b.add_point_light({0, 0, 0}, static_cast<float>(10 * scale * scale));
    b.add_camera({0, 0, 0}, {0, -0.5f, -1});
    // In double precision, as a file may have them.
    b.film().nodes[static_cast<std::size_t>(b.film().lights.back().node)].translation =
        offset + scale * glm::dvec3(1, 2.5, 1);
    b.film().nodes[static_cast<std::size_t>(b.film().cameras.back().node)].translation =
        offset + scale * glm::dvec3(0, 2, 3.5);
    return b;
}

/// A floor made of one quad, or of needles beside and on top of it.
SceneBuilder needled(bool needles) {
    SceneBuilder b = floor_from_above();
    b.add_point_light({0, 2, 0}, 1);
    if (!needles) return b;
    scene::Mesh mesh;
    for (int i = 0; i < 64; ++i) {
        const auto z = static_cast<float>(i) * 1e-5f;
        SceneBuilder::append(mesh, SceneBuilder::quad({-5, 1e-3f, 1e-6f + z}, {10, 0, 0}, {0, 0, -1e-6f}));
    }
    b.add_object(b.add_mesh(std::move(mesh)), 0);
    return b;
}

SceneBuilder floor_and(const std::function<void(scene::Mesh&)>& change) {
    SceneBuilder b = floor_from_above();
    b.add_point_light({0.5f, 2, 0}, 1);
    change(b.film().meshes.front());
    return b;
}

}  // namespace

std::vector<HardCase> surface_cases() {
    std::vector<HardCase> cases = {
        {"nothing in the scene", "boxes and radii of nothing", "the sky's colour everywhere",
         [] {
             SceneBuilder b;
             b.film().sky.color = {0.25f, 0.5f, 0.75f};
             b.add_camera({0, 0, 0}, {0, 0, -1});
             return b;
         },
         [](const Lit& film) { EXPECT_EQ(film.at(3, 5), glm::vec3(0.25f, 0.5f, 0.75f)); }},
        {"triangles without area", "normals of length 0, areas as divisors", "they are not there",
         [] {
             return floor_and([](scene::Mesh& mesh) {
                 for (std::uint32_t i = 0; i < 50; ++i) mesh.triangles.push_back({0, i % 4, i % 4});
             });
         },
         [](const Lit& film) { expect_same(film, floor_and([](scene::Mesh&) {})); }},
        {"needles of ten million to one", "barycentrics are noise, shadow rays meet the needle they start on",
         "no speckles: as bright as without them", [] { return needled(true); },
         [](const Lit& film) { expect_like(film, needled(false), 0.02); }},
        {"a corner that is no number",
         "the tree of rays is built from NaN",
         "a line that names the mesh",
         [] { return floor_and([](scene::Mesh& mesh) { mesh.positions[1].y = NAN; }); },
         {},
         {},
         "mesh 0"},
        {"a triangle whose corner is not there",
         "memory beyond the corners is read",
         "a line that names the mesh",
         [] { return floor_and([](scene::Mesh& mesh) {
                  mesh.triangles.push_back({0, 1, 99});
              }); },
         {},
         {},
         "mesh 0"},
        {"normals of length 0", "normalising them", "the triangle's own normal takes their place",
         [] { return floor_and([](scene::Mesh& mesh) { mesh.normals.assign(4, glm::vec3(0)); }); },
         [](const Lit& film) { expect_like(film, floor_and([](scene::Mesh&) {}), 0.01); }},
        {"normals that point into the surface", "negative cosines, or light from the back",
         "as bright as with normals that point out",
         [] { return floor_and([](scene::Mesh& mesh) { mesh.normals.assign(4, glm::vec3(0, -1, 0)); }); },
         [](const Lit& film) { expect_like(film, floor_and([](scene::Mesh&) {}), 0.01); }},
        {"a scene of 1e-4", "every fixed distance is larger than the scene", "the same picture, bit for bit",
         [] { return table(std::ldexp(1.0, -13)); }, [](const Lit& film) { expect_same(film, table()); }},
        {"a scene of 1e6", "every fixed distance is lost in rounding", "the same picture, bit for bit",
         [] { return table(std::ldexp(1.0, 20)); }, [](const Lit& film) { expect_same(film, table()); }},
        {"a scene a million of its sizes away", "seven digits are used up by the distance",
         "the same picture but for rounding",
         [] {
             return table(1, {3e6, -1e6, 2e6});
         },
         [](const Lit& film) { expect_like(film, table(), 0.01); }},
        {"a screw of a millimetre in a hall of a kilometre", "one epsilon for both",
         "both are lit, nothing is speckled",
         [] {
             SceneBuilder b;
             b.add_box({-500, 0, -500}, {500, 300, 500}, b.add_material(glm::vec3(0.5f)), true);
             b.add_sphere({0, 0.0005f, 0}, 0.0005f, b.add_material(glm::vec3(0.5f)), 8);
             b.add_point_light({0.1f, 0.2f, 0.1f}, 0.01f);
             b.add_camera({0, 0.002f, 0.003f}, {0, 0.0005f, 0});
             return b;
         },
         [](const Lit& film) {
             EXPECT_GT(film.at(16, 16).y, 0.0f);
             EXPECT_GT(film.at(2, 30).y, 0.0f);
         }},
        {"two surfaces in one plane", "which is seen and which shades is left to rounding",
         "the same one in every frame",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, b.add_material({0.1f, 0.5f, 0.1f}));
             b.add_point_light({0.5f, 2, 0}, 1);
             return b;
         },
         [](const Lit& film) {
             EXPECT_GT(
                 *std::min_element(film.decoded.front().y.values().begin(), film.decoded.front().y.values().end()), 16);
             if (film.way == Way::coupled) return;
             EXPECT_TRUE(same_values(film.frames[0].combined, film.frames[2].combined));
         }},
        of_side({"a wall a millionth thick", "light starts on the wrong side of it", "behind it is black",
                 [] {
                     SceneBuilder b;
                     const int white = b.add_material(glm::vec3(0.5f));
                     b.add_box({-2, 0, -2}, {2, 3, 2}, white, true);
                     b.add_box({-2, 1.5f, -2}, {2, 1.500001f, 2}, white);
                     b.add_point_light({0.3f, 2.5f, 0.3f}, 10);
                     b.add_camera({0, 1.2f, 1.5f}, {0, 0, -1});
                     return b;
                 },
                 [](const Lit& film) { EXPECT_EQ(film.brightest(), 0.0f); }},
                16),
        {"a mirrored object", "its triangles turn inside out", "lit as its image in a mirror",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_object(b.add_mesh(SceneBuilder::sphere(0.5f, 12)), 0, {0.6, 0.5, 0}, {1, 0, 0, 0}, {-1, 1, 1});
             b.add_point_light({0, 1.9f, 0}, 1);
             return b;
         },
         [](const Lit& film) {
             SceneBuilder b = floor_from_above();
             b.add_object(b.add_mesh(SceneBuilder::sphere(0.5f, 12)), 0, {-0.6, 0.5, 0});
             b.add_point_light({0, 1.9f, 0}, 1);
             expect_like(film, b, 0.02);
         }},
        {"an object flattened to nothing along one axis", "its matrix has no inverse, its normals none",
         "a flat thing, lit",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_object(b.add_mesh(SceneBuilder::sphere(0.5f, 12)), 0, {0, 0.5, 0}, {1, 0, 0, 0}, {1, 0, 1});
             b.add_point_light({0.2f, 1.9f, 0}, 1);
             return b;
         },
         [](const Lit& film) { EXPECT_GT(film.mean(), 0.0); }},
        {"a ball stretched and turned", "normals need the inverse transpose",
         "as if its corners had been stretched in the file",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_object(b.add_mesh(SceneBuilder::sphere(0.4f, 12)), 0, {0, 0.5, 0}, {1, 0, 0, 0}, {2, 0.25, 1});
             b.add_point_light({1, 1.9f, 0}, 1);
             return b;
         },
         [](const Lit& film) {
             scene::Mesh mesh = SceneBuilder::sphere(0.4f, 12);
             for (glm::vec3& p : mesh.positions) p *= glm::vec3(2, 0.25f, 1);
             for (glm::vec3& n : mesh.normals) n = glm::normalize(n / glm::vec3(2, 0.25f, 1));
             SceneBuilder b = floor_from_above();
             b.add_object(b.add_mesh(std::move(mesh)), 0, {0, 0.5, 0});
             b.add_point_light({1, 1.9f, 0}, 1);
             expect_like(film, b, 0.01);
         }},
    };
    return cases;
}

}  // namespace render2mpeg::test
