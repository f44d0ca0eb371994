#include "tests/bench/coupled_films.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/color.h"
#include "core/error.h"
#include "perceptual/hvs.h"
#include "perceptual/metrics.h"
#include "scene/motion.h"

namespace render2mpeg::bench {
namespace {

using app::Production;

std::uint64_t hash_of(std::uint64_t hash, const char* bytes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 0x100000001b3u;
    return hash;
}
template <class T>
std::uint64_t hash_of(std::uint64_t hash, const T& value) {
    return hash_of(hash, reinterpret_cast<const char*>(&value), sizeof value);
}

/// What a reference depends on: where things are in this frame, and the settings. Textures are not in it.
std::uint64_t key_of(const Production& film, std::int64_t frame) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const scene::Snapshot world = film.snapshot(frame);
    hash = hash_of(hash, film.animation->source.data(), film.animation->source.size());
    for (const scene::ObjectState& object : world.objects) hash = hash_of(hash, object.to_world);
    for (const scene::DeformedMesh& mesh : world.deformed)
        hash = hash_of(hash, reinterpret_cast<const char*>(mesh.positions.data()),
                       mesh.positions.size() * sizeof(glm::vec3));
    for (const scene::LightState& light : world.lights) hash = hash_of(hash, light.intensity);
    hash = hash_of(hash_of(hash, world.camera.to_world()), world.camera.lens().vertical_fov);
    const renderer::Settings& s = film.rendering;
    for (const std::int64_t value : {frame, std::int64_t{s.format.width}, std::int64_t{s.format.height},
                                     std::int64_t{s.samples}, std::int64_t{s.vpls}, std::int64_t{s.direct_points}})
        hash = hash_of(hash, value);
    return hash;
}

bool read(const std::filesystem::path& file, core::Plane<glm::vec3>& plane) {
    std::ifstream stream(file, std::ios::binary);
    const auto size = static_cast<std::streamsize>(plane.size() * sizeof(glm::vec3));
    return stream.read(reinterpret_cast<char*>(plane.values().data()), size).gcount() == size;
}

core::Picture develop(const Production& film, core::Plane<glm::vec3> light, std::int64_t frame) {
    const perceptual::Display display(film.exposure.value_or(0), perceptual::matrix_for(film.format.height));
    core::Radiance radiance;
    radiance.combined = std::move(light);
    core::Picture picture = display.develop(radiance);
    picture.number = frame;
    return picture;
}

/// Sums over the reference's frames.
class Judge {
  public:
    Judge(const Production& film, const Reference& reference) : film_(film), reference_(reference) {}

    void lit(const app::LitFrame& frame) {
        const auto truth = reference_.light.find(frame.world.frame);
        if (truth == reference_.light.end()) return;
        const bool exact = frame.tolerance.is_reference();
        for (std::size_t i = 0; i < truth->second.size(); ++i) {
            const float y = core::luminance(truth->second.values()[i]);
            const core::Tolerance t = exact ? core::Tolerance{} : frame.tolerance.pixels.values()[i];
            const float allowed = std::max(t.absolute, t.relative * y);
            over_ += std::abs(core::luminance(frame.radiance.combined.values()[i]) - y) > allowed * 1.0001f + 1e-12f;
            if (y > 0) relative_ += static_cast<double>(std::min(allowed / y, 1.0f)), bright_ += 1;
            const double d = static_cast<double>(frame.picture.luma.values()[i]) -
                             static_cast<double>(reference_.pictures.at(frame.world.frame).luma.values()[i]);
            light_ += d * d;
            pixels_ += 1;
        }
        visible_[frame.world.frame] = frame.visible;
    }
    void coded(const encoder::CodedPicture& picture) {
        bytes_ += static_cast<double>(picture.bytes.size());
        const auto truth = reference_.pictures.find(picture.plan.number);
        if (truth == reference_.pictures.end()) return;
        mse_ += perceptual::mean_squared_error(picture.reconstruction.y, truth->second.y);
        ssim_ += perceptual::ssim(picture.reconstruction.y, truth->second.y);
        hvs_ += perceptual::masked_error(picture.reconstruction.y, truth->second.y);
        decoded_[picture.plan.number] = picture.reconstruction.y;
        count_ += 1;
    }
    void add_to(Outcome& out) const {
        out.over = over_ / pixels_;
        out.tolerance = relative_ / bright_;
        out.light_mse = light_ / pixels_;
        out.bytes = bytes_;
        out.psnr_y = perceptual::psnr(mse_ / count_);
        out.ssim = ssim_ / count_;
        out.hvs_m = perceptual::psnr(hvs_ / count_);
        for (const std::int64_t a : reference_.firsts) {
            const core::MotionField motion =
                scene::motion_between(visible_.at(a + 1), film_.snapshot(a + 1), film_.snapshot(a));
            out.flicker += (difference(decoded_.at(a + 1), decoded_.at(a), motion) -
                            difference(reference_.pictures.at(a + 1).y, reference_.pictures.at(a).y, motion)) /
                           static_cast<double>(reference_.firsts.size());
        }
    }
    void see(std::int64_t frame, const core::Visible& visible) { visible_[frame] = visible; }

  private:
    /// Mean absolute difference along motion, bilinear.
    static double difference(const core::Plane<std::uint8_t>& now, const core::Plane<std::uint8_t>& before,
                             const core::MotionField& motion) {
        double sum = 0, count = 0;
        for (int y = 0; y < now.height(); ++y)
            for (int x = 0; x < now.width(); ++x) {
                if (motion.kind.at(x, y) == core::PixelClass::none) continue;
                const glm::vec2 v = motion.vector.at(x, y);
                const float px = static_cast<float>(x) + v.x, py = static_cast<float>(y) + v.y;
                const int x0 = static_cast<int>(std::floor(px)), y0 = static_cast<int>(std::floor(py));
                if (!(px >= 0 && py >= 0) || x0 + 1 >= now.width() || y0 + 1 >= now.height()) continue;
                const float s = px - static_cast<float>(x0), t = py - static_cast<float>(y0);
                const float there = (1 - t) * ((1 - s) * before.at(x0, y0) + s * before.at(x0 + 1, y0)) +
                                    t * ((1 - s) * before.at(x0, y0 + 1) + s * before.at(x0 + 1, y0 + 1));
                sum += std::abs(static_cast<double>(now.at(x, y)) - static_cast<double>(there));
                count += 1;
            }
        return count > 0 ? sum / count : 0.0;
    }

    const Production& film_;
    const Reference& reference_;
    double over_ = 0, relative_ = 0, bright_ = 0, light_ = 0, pixels_ = 0, bytes_ = 0, mse_ = 0, ssim_ = 0, hvs_ = 0,
           count_ = 0;
    std::map<std::int64_t, core::Visible> visible_;
    std::map<std::int64_t, core::Plane<std::uint8_t>> decoded_;
};

class Watching : public app::Watcher {
  public:
    explicit Watching(Judge& judge) : judge_(judge) {}
    void lit(const app::LitFrame& frame) override {
        judge_.lit(frame);
        if (visible != nullptr) visible->push_back(frame.visible), pictures->push_back(frame.picture);
    }
    void coded(const encoder::CodedPicture& picture) override { judge_.coded(picture); }

    std::vector<core::Visible>* visible = nullptr;
    std::vector<core::Picture>* pictures = nullptr;

  private:
    Judge& judge_;
};

Outcome cost_of(const app::Ledger& ledger) {
    const renderer::Statistics& s = ledger.rendering;
    Outcome out;
    out.preview_seconds = ledger.stage_seconds(app::Stage::preview);
    out.shade_seconds = ledger.stage_seconds(app::Stage::shade) + out.preview_seconds;
    out.tolerate_seconds = ledger.stage_seconds(app::Stage::tolerate);
    out.rays = static_cast<double>(s.shadow_rays);
    const auto points = static_cast<double>(std::max<std::uint64_t>(1, s.gather_points));
    out.cut = static_cast<double>(s.direct_clusters + s.indirect_clusters) / points /
              static_cast<double>(std::max<std::size_t>(1, s.direct_points + s.indirect_points));
    out.capped = static_cast<double>(s.capped_points) / points;
    return out;
}

app::Ledger run(const Production& film, app::Watcher& watcher) {
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan);
    app::Ledger ledger;
    app::Destination destination;
    destination.watcher = &watcher;
    for (const app::Chunk& chunk : app::chunks_of(film.frames, film.coding.gop))
        app::render_chunk(film, renderer, chunk, destination, ledger, [] { return true; });
    ledger.rendering = renderer.statistics();
    return ledger;
}

}  // namespace

Reference reference_of(const Production& film, int pairs, const std::filesystem::path& cache) {
    Reference reference;
    std::filesystem::create_directories(cache);
    for (int i = 0; i < pairs; ++i)
        reference.firsts.push_back(film.frames.first + (film.frame_count() - 2) * (2 * i + 1) / (2 * pairs));
    std::optional<renderer::Renderer> renderer;
    for (const std::int64_t first : reference.firsts)
        for (const std::int64_t n : {first, first + 1}) {
            const std::filesystem::path file = cache / fmt::format("{:016x}.light", key_of(film, n));
            core::Plane<glm::vec3> light(film.format.width, film.format.height);
            if (!read(file, light)) {
                if (!renderer) {
                    renderer.emplace(*film.animation, film.rendering, film.plan);
                    renderer->start_chunk(film.snapshot(film.frames.first));
                }
                const scene::Snapshot world = film.snapshot(n);
                light = renderer->shade(world, renderer->see(world), core::ToleranceMap::reference()).combined;
                std::ofstream(file, std::ios::binary)
                    .write(reinterpret_cast<const char*>(light.values().data()),
                           static_cast<std::streamsize>(light.size() * sizeof(glm::vec3)));
            }
            reference.pictures[n] = develop(film, light, n);
            reference.light[n] = std::move(light);
        }
    return reference;
}

Outcome made(const Production& film, const Reference& reference) {
    Judge judge(film, reference);
    Watching watching(judge);
    Outcome out = cost_of(run(film, watching));
    judge.add_to(out);
    return out;
}

LitFilm::LitFilm(const Production& film, const Reference& reference) : film_(film), reference_(reference) {
    Judge judge(film, reference);
    Watching watching(judge);
    watching.visible = &visible_;
    watching.pictures = &pictures_;
    lit_ = cost_of(run(film, watching));
    judge.add_to(lit_);
}

Outcome LitFilm::coded(int quantiser) const {
    Judge judge(film_, reference_);
    Production film = film_;
    film.coding.quantiser = quantiser;
    for (const app::Chunk& chunk : app::chunks_of(film.frames, film.coding.gop)) {
        encoder::Encoder encoder(film.coding);
        const auto take = [&](const std::vector<encoder::CodedPicture>& pictures) {
            for (const encoder::CodedPicture& picture : pictures) judge.coded(picture);
        };
        for (std::int64_t n = chunk.first; n <= chunk.last; ++n) {
            const auto i = static_cast<std::size_t>(n - film.frames.first);
            const scene::Snapshot world = film.snapshot(n);
            const encoder::PicturePlan plan = encoder.plan(n, app::facts_of(film, world, chunk), n == chunk.first);
            judge.see(n, visible_[i]);
            const auto onward = app::onward_motion(film, plan, visible_[i], world);
            take(encoder.push(pictures_[i], plan, app::motion_of(film, plan, visible_[i], world),
                              {onward ? &*onward : nullptr}));
        }
        take(encoder.flush());
    }
    Outcome out = lit_, sums;
    judge.add_to(sums);
    out.bytes = sums.bytes;
    out.psnr_y = sums.psnr_y;
    out.ssim = sums.ssim;
    out.hvs_m = sums.hvs_m;
    out.flicker = sums.flicker;
    return out;
}

}  // namespace render2mpeg::bench
