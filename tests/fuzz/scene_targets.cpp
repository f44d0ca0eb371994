#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "core/error.h"
#include "core/numeric.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "scene/isolation/probe.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"
#include "scene/preparation/traits.h"
#include "scene/volumes/volume_reader.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::fuzz {
namespace {

/// What the rest of the program relies on, at some instants of a film that was not refused.
void expect_sound(const scene::Animation& film) {
    scene::traits_of(film);
    if (film.cameras.empty()) throw std::logic_error("a film without a camera");
    for (const scene::Object& object : film.objects) {
        const scene::Mesh& mesh = film.meshes.at(static_cast<std::size_t>(object.mesh));
        if (static_cast<std::size_t>(object.material) >= film.materials.size())
            throw std::logic_error("an object without a material");
        for (const glm::uvec3& t : mesh.triangles)
            if (std::max({t.x, t.y, t.z}) >= mesh.positions.size()) throw std::logic_error("an index beyond its mesh");
    }
    for (const double share : {0.0, 0.31, 1.0}) {
        const auto ms = static_cast<std::int64_t>(1000 * std::min(share * film.duration, 1e6));
        const scene::Snapshot world = scene::snapshot_at(film, ms, {ms, 1000}, {16, 16, 1.0f});
        for (std::size_t i = 0; i < world.objects.size(); ++i) {
            if (!world.objects[i].present) continue;
            if (!core::is_finite(world.objects[i].to_world)) throw std::logic_error("an object is nowhere");
            const scene::Triangle t = scene::triangle_of(world, static_cast<std::uint32_t>(i), 0);
            for (const glm::vec3& corner : {t.a, t.b, t.c})
                if (!core::is_finite(corner)) throw std::logic_error("a corner is nowhere");
        }
        for (const scene::LightState& light : world.lights)
            if (!core::is_finite(light.position) || !core::is_finite(light.intensity))
                throw std::logic_error("a light is nowhere, or endless");
    }
}

template <class T, class Sound>
void expect_sound(const core::SparseGrid<T>& grid, const Sound& is_sound) {
    grid.each([&](glm::ivec3, const auto& brick) {
        if (!std::all_of(brick.begin(), brick.end(), is_sound)) throw std::logic_error("a voxel that no medium has");
    });
}

void expect_sound(const scene::VolumeGrids& grids) {
    const auto amount = [](float v) { return v >= 0 && std::isfinite(v); };
    expect_sound(grids.density, amount);
    expect_sound(grids.temperature, amount);
    expect_sound(grids.color, [](glm::vec3 v) {
        return std::min({v.x, v.y, v.z}) >= 0 && std::max({v.x, v.y, v.z}) <= 1;
    });
    const double size = glm::determinant(glm::dmat3(grids.object_from_index));
    if (!std::isfinite(size) || size == 0) throw std::logic_error("a volume without a place");
}

bool loads(const scene::Volume& volume) {
    try {
        std::vector<std::string> notes;
        scene::outline_of(volume);
        expect_sound(*scene::read_volume(volume, 0, notes));
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

bool loads(const std::filesystem::path& file) {
    try {
        expect_sound(scene::load(file));
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

/// The endings whose parsers Assimp's files are read by.
constexpr std::array<std::string_view, 13> endings{"obj", "ply", "stl", "off", "dae", "3ds", "fbx",
                                                   "x",   "ac",  "ase", "lwo", "smd", "bvh"};

}  // namespace

bool gltf(Input input) {
    return loads(input_file().write("scene.gltf", input));
}

bool animation(Input input) {
    return loads(input_file().write("film.json", input));
}

bool model(Input input) {
    const auto end = std::find(input.begin(), input.end(), '\n');
    const std::string ending(input.begin(), end);
    if (end == input.end() || std::find(endings.begin(), endings.end(), ending) == endings.end()) return false;
    // A crash of Assimp's must end another process, as it does in the program.
    if (!scene::Probe::is_possible()) throw std::logic_error("there is no program that reads models");
    return loads(input_file().write("model." + ending, input.subspan(ending.size() + 1)));
}

bool volume(Input input) {
    // A crash of OpenVDB's must end another process, too.
    if (!scene::Probe::is_possible()) throw std::logic_error("there is no program that reads volumes");
    scene::Volume dense, burning;
    dense.files = burning.files = {input_file().write("volume.vdb", input)};
    burning.blackbody_intensity = 1;
    burning.color_grid = "color";
    return loads(burning) || loads(dense);
}

bool tracks(Input input) {
    Numbers numbers(input);
    test::SceneBuilder builder;
    builder.add_box({0, 0, 0}, {1, 1, 1}, builder.add_material(glm::vec3(0.5f)));
    builder.add_camera({0, 0, 4}, {0, 0, 0});
    scene::Animation film = builder.unfinished();
    film.lights.emplace_back().node = film.objects.front().node;
    film.lights.front().intensity = 1;
    while (numbers.left() && film.tracks.size() < 8) {
        scene::Track track;
        track.target = static_cast<scene::TrackTarget>(numbers.pick(0, 7));
        track.interpolation = static_cast<scene::Interpolation>(numbers.pick(0, 2));
        track.index = numbers.pick(-1, 2);
        track.width = numbers.pick(1, 4);
        const int keys = numbers.pick(0, 5), values = keys * track.width + numbers.pick(0, 15) / 15;
        const bool rising = numbers.pick(0, 3) > 0;
        float time = 0;
        for (int k = 0; k < keys; ++k) {
            time = rising ? time + 0.25f * static_cast<float>(numbers.pick(0, 9)) : numbers.any_float();
            track.times.push_back(time);
        }
        const int parts = track.interpolation == scene::Interpolation::cubic_spline ? 3 : 1;
        for (int v = 0; v < parts * values; ++v)
            track.values.push_back(numbers.pick(0, 1) > 0 ? numbers.any_float()
                                                          : 0.1f * static_cast<float>(numbers.pick(-20, 20)));
        film.tracks.push_back(std::move(track));
    }
    film.source = "fuzz";
    try {
        scene::complete(film);
    } catch (const core::Error&) {
        return false;
    }
    expect_sound(film);
    return true;
}

}  // namespace render2mpeg::fuzz
