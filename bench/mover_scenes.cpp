#include "bench/mover_scenes.h"

#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::bench {
namespace {

using test::SceneBuilder;

SceneBuilder room() {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {5, 3, 5}, b.add_material({0.7f, 0.6f, 0.5f}), true);
    b.add_box({3.0f, 0, 1.0f}, {4.0f, 1.5f, 2.0f}, b.add_material({0.3f, 0.5f, 0.7f}));
    b.add_point_light({2, 2.4f, 3}, 20.0f, {1, 0.8f, 0.6f});
    b.add_camera({2.5f, 1.7f, 4.9f}, {2.5f, 1.0f, 0.0f}, 1.1f);
    return b;
}

void add_ball(SceneBuilder& b) {
    const int ball = b.add_sphere({0, 0, 0}, 0.4f, b.add_material(glm::vec3(0.9f)), 10);
    b.move_object(ball, {{1, 0.6f, 3}, {4.0f, 0.6f, 3}});
}

void add_board(SceneBuilder& b, float off_wall) {
    const int board = b.add_box({-0.3f, -0.3f, 0}, {0.3f, 0.3f, 0.02f}, b.add_material(glm::vec3(0.9f)));
    b.move_object(board, {{1.0f, 1.5f, off_wall}, {2.5f, 1.5f, off_wall}, {4.0f, 1.5f, off_wall}});
}

void add_swarm(SceneBuilder& b) {
    const int white = b.add_material(glm::vec3(0.9f));
    for (std::uint64_t i = 0; i < 60; ++i) {
        const int ball = b.add_sphere({0, 0, 0}, 0.08f, white, 8);
        std::vector<glm::vec3> places;
        for (std::uint64_t k = 0; k < 3; ++k)
            places.push_back({0.3f + 4.4f * core::uniform(1, i, 3 * k), 0.3f + 2.0f * core::uniform(1, i, 3 * k + 1),
                              0.3f + 4.0f * core::uniform(1, i, 3 * k + 2)});
        b.move_object(ball, places);
    }
}

void add_columns(SceneBuilder& b, bool instances) {
    const int white = b.add_material(glm::vec3(0.8f));
    scene::Mesh column = SceneBuilder::box({-0.15f, 0, -0.15f}, {0.15f, 3, 0.15f}, false);
    scene::Mesh filling = SceneBuilder::sphere(0.1f, 100);
    filling.normals.clear();
    SceneBuilder::append(column, filling);
    const int mesh = b.add_mesh(column);
    for (const double x : {1.25, 2.5, 3.75}) b.add_object(instances ? mesh : b.add_mesh(column), white, {x, 0, 2.5});
}

}  // namespace

test::SceneBuilder mover_scene(const std::string& name) {
    SceneBuilder b = room();
    if (name == "ball")
        add_ball(b);
    else if (name == "along_wall")
        add_board(b, 0.04f);
    else if (name == "touching_wall")
        add_board(b, 0.001f);
    else if (name == "swarm")
        add_swarm(b);
    else if (name == "copies" || name == "columns") {
        add_columns(b, name == "copies");
        add_ball(b);
    } else
        throw core::Error(name + ": no such scene");
    return b;
}

std::vector<std::string> names_of_mover_scenes() {
    return {"ball", "along_wall", "touching_wall", "swarm", "copies", "columns"};
}

}  // namespace render2mpeg::bench
