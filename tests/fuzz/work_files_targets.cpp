// Files of a film in the making, and its sound.
#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/files/work_folder.h"
#include "core/archive.h"
#include "core/error.h"
#include "core/isa.h"
#include "core/rational.h"
#include "encoder/av/av.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "renderer/renderer.h"
#include "scene/preparation/traits.h"
#include "support/scene_builder.h"

namespace render2mpeg::fuzz {

bool sound(Input input) {
    const std::filesystem::path file = input_file().write("sound.wav", input);
    try {
        if (const int channels = av::channels_of_sound(file); channels != 1 && channels != 2)
            throw std::logic_error("so many channels are in no film");
        encoder::Settings settings;
        settings.width = settings.height = 16;
        bool is_open = true;
        av::Muxer muxer([&](std::span<const std::uint8_t>) { return is_open; }, "film.ts", settings,
                        {file, 0.0, 0.08, false, 2});
        // A sequence header, and pictures that nobody decodes.
        const std::vector<std::uint8_t> header{0,    0, 1, 0xb3, 1,    0,    0x10, 0x13, 0x24, 0x9f, 0x23,
                                               0x80, 0, 0, 1,    0xb5, 0x14, 0x8a, 0,    1,    0,    0},
            picture{0, 0, 1, 0, 0, 0xf, 0xff, 0xf8};
        std::vector<std::uint8_t> first = header;
        first.insert(first.end(), picture.begin(), picture.end());
        muxer.write(first, 0, 0, true);
        muxer.write(picture, 1, 1, false);
        muxer.finish();
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

bool chunk(Input input) {
    const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
    const std::size_t line = std::min(text.find('\n'), text.size());
    nlohmann::json record = app::parsed_json(text.substr(0, line));
    if (!record.is_object()) return false;
    const std::filesystem::path file =
        input_file().write("chunk_00000.m2v", input.subspan(std::min(line + 1, input.size())));
    // Whoever forges a record sums it up.
    record["checksum"] = app::text_of(core::checksum_of(file));
    const std::string said = record.dump();
    input_file().write("chunk_00000.json", std::span(reinterpret_cast<const std::uint8_t*>(said.data()), said.size()));
    try {
        const auto reopened = app::ChunkFile::reopened(file, {0, 0, 1});
        if (!reopened) return false;
        app::Film film;
        film.frames = {0, 1};
        film.coding.width = film.coding.height = 16;
        film.coding.rate = core::frame_rate_from("25");
        app::WorkFolder work(file.parent_path() / "film.mpg", nlohmann::json::object());
        app::publish(std::span(&*reopened, 1), film, work, file.parent_path() / "film.mpg", true);
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

namespace {

constexpr std::uint64_t mark_of_state = 1;
constexpr int state_size = 16, state_frames = 2;

/// A ball that moves in the corner of a yard, and what its first frames leave for the next.
struct LitYard {
    LitYard() : film(scene()), plan(renderer::make_plan(scene::traits_of(film), wanted())) {
        settings.format = {state_size, state_size, 1.0f};
        settings.samples = 1;
        settings.direct_points = 32;
        settings.vpls = 64;
        settings.cache = renderer::CacheUse::static_light;
        settings.isa = core::detect_isa();
        const auto renderer = started();
        for (int n = 0; n < state_frames; ++n) light(*renderer, n);
        const std::filesystem::path file = input_file().write("whole.state", {});
        core::ArchiveWriter writer(file, mark_of_state);
        renderer->save(writer);
        writer.finish();
        std::ifstream stream(file, std::ios::binary);
        stream.seekg(core::ArchiveReader::header_bytes);
        state.assign(std::istreambuf_iterator<char>(stream), {});
    }

    static renderer::Wanted wanted() {
        renderer::Wanted all;
        all.by_rays = all.indirect = true;
        return all;
    }
    static scene::Animation scene() {
        test::SceneBuilder b;
        const int white = b.add_material({0.7f, 0.7f, 0.7f});
        b.add_quad({-4, 0, 8}, {12, 0, 0}, {0, 0, -12}, white);
        b.add_quad({-4, 0, -4}, {12, 0, 0}, {0, 6, 0}, white);
        b.add_sun({0.3f, -1, -0.5f}, 2);
        b.film().sky.color = {0.2f, 0.3f, 0.4f};
        const int ball = b.add_sphere({1.2f, 0.6f, 1.5f}, 0.6f, b.add_material({0.7f, 0.2f, 0.1f}), 6);
        b.move_object(ball, {{0, 0, 0}, {0.2f, 0, 0}, {0.4f, 0, 0}, {0.6f, 0, 0}});
        b.add_camera({2.0f, 1.6f, 3.8f}, {2.0f, 1.0f, 0.0f}, 1.1f);
        return b.build();
    }
    scene::Snapshot at(int frame) const { return test::snapshot(film, frame, state_size, state_size); }
    std::unique_ptr<renderer::Renderer> started() const {
        auto renderer = std::make_unique<renderer::Renderer>(film, settings, plan);
        renderer->start_chunk(at(0));
        return renderer;
    }
    void light(renderer::Renderer& renderer, int frame) const {
        const scene::Snapshot world = at(frame);
        const core::Radiance lit =
            renderer
                .light(world, renderer.look(world), {core::ToleranceMap::uniform(state_size, state_size, {0.0f, 0.1f})})
                .radiance;
        if (lit.combined.size() != std::size_t{state_size} * state_size) throw std::logic_error("light of no frame");
    }

    scene::Animation film;
    renderer::Plan plan;
    renderer::Settings settings;
    std::vector<std::uint8_t> state;
};

}  // namespace

bool state(Input input) {
    static const LitYard yard;
    // Changes to what the very same program wrote: places, and what stands there.
    std::vector<std::uint8_t> state = yard.state;
    for (Numbers numbers(input); numbers.left();) {
        const std::size_t place = numbers.word() % state.size(), count = 1 + numbers.byte() % 8;
        for (std::size_t i = place; i < std::min(place + count, state.size()); ++i)
            state[i] = static_cast<std::uint8_t>(numbers.byte());
    }
    const std::filesystem::path file = input_file().write("chunk_00000.state", {});
    {
        core::ArchiveWriter writer(file, mark_of_state);
        writer.bytes(state.data(), state.size());
        writer.finish();
    }
    try {
        const auto reader = core::ArchiveReader::open(file, mark_of_state);
        if (!reader) throw std::logic_error("a state that was just written is not read");
        const auto renderer = yard.started();
        const std::array<scene::Snapshot, state_frames> worlds{yard.at(0), yard.at(1)};  // outlive what looks at them
        for (const scene::Snapshot& world : worlds) renderer->prepare(world);
        renderer->restore(*reader);
        yard.light(*renderer, state_frames);
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

}  // namespace render2mpeg::fuzz
