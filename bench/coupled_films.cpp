#include "bench/coupled_films.h"
#include "encoder/encoder.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "app/loop/picture_coder.h"
#include "core/color.h"
#include "perceptual/display.h"
#include "perceptual/metrics.h"
#include "perceptual/pumping.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::bench {
namespace {

using app::RenderJob;

/// Takes the light of the reference's frames.
class LightJudge {
  public:
    LightJudge(const RenderJob& film, const Stage& stage)
        : stage_(stage), display_(film.exposure.value_or(0), perceptual::matrix_for(film.format.height)) {}

    void lit(const app::LitFrame& frame) {
        const auto known = stage_.reference.find(frame.world.frame);
        if (known == stage_.reference.end()) return;
        const ReferenceFrame& truth = known->second;
        for (std::size_t i = 0; i < truth.light.size(); ++i) {
            const double d = static_cast<double>(frame.picture.luma.values()[i]) -
                             static_cast<double>(truth.picture.luma.values()[i]);
            light_ += d * d;
            pixels_ += 1;
            if (truth.gathers.values()[i] == 0) continue;
            const glm::vec3 light = truth.light.values()[i];
            const float y = core::luminance(light);
            const core::Tolerance t = frame.tolerance.pixels.values()[i];
            const float allowed = t.allows(y);
            over_ +=
                std::abs(core::luminance(frame.lit.radiance.combined.values()[i]) - y) > allowed * 1.0001f + 1e-12f;
            gathering_ += 1;
            if (!(y > 0)) continue;
            relative_ += static_cast<double>(std::min(allowed / y, 1.0f)), bright_ += 1;
            const double codes = static_cast<double>(perceptual::luma_of(display_, light * (1 + allowed / y)) -
                                                     perceptual::luma_of(display_, light));
            luma_ += codes * codes;
        }
    }
    void add_to(Outcome& out) const {
        out.over = over_ / std::max(gathering_, 1.0);
        out.tolerance = relative_ / std::max(bright_, 1.0);
        out.tolerance_luma = std::sqrt(luma_ / std::max(bright_, 1.0));
        out.light_mse = light_ / pixels_;
    }

  private:
    const Stage& stage_;
    perceptual::Display display_;
    double over_ = 0, gathering_ = 0, relative_ = 0, luma_ = 0, bright_ = 0, light_ = 0, pixels_ = 0;
};

/// Takes all decoded pictures.
class CodingJudge {
  public:
    CodingJudge(const RenderJob& film, const Stage& stage) : first_(film.frames.first), stage_(stage) {}

    void coded(const encoder::CodedPicture& picture) {
        const std::int64_t n = picture.plan.number;
        bytes_ += static_cast<double>(picture.bytes.size());
        decoded_[n] = picture.reconstruction.y;
        intra_[n] = picture.plan.type == encoder::PictureType::intra;
        const auto known = stage_.reference.find(n);
        if (known == stage_.reference.end()) return;
        const core::Picture &truth = known->second.picture, &made = picture.reconstruction;
        mse_ += perceptual::mean_squared_error(made.y, truth.y);
        chroma_ += 0.5 * (perceptual::mean_squared_error(made.cb, truth.cb) +
                          perceptual::mean_squared_error(made.cr, truth.cr));
        ssim_ += perceptual::ssim(made.y, truth.y);
        hvs_ += perceptual::masked_error(made.y, truth.y);
        count_ += 1;
    }
    void add_to(Outcome& out) const {
        out.bytes = bytes_;
        out.psnr_y = perceptual::psnr(mse_ / count_);
        out.psnr_c = perceptual::psnr(chroma_ / count_);
        out.ssim = ssim_ / count_;
        out.hvs_m = perceptual::psnr(hvs_ / count_);
        out.flicker = 0;
        for (const std::int64_t a : stage_.firsts)
            out.flicker += (step(a + 1) - perceptual::change_along(motion(a + 1), stage_.reference.at(a + 1).picture.y,
                                                                   stage_.reference.at(a).picture.y)) /
                           static_cast<double>(stage_.firsts.size());
        double sum[2] = {}, frames[2] = {};
        for (std::int64_t n = first_ + 1; decoded_.contains(n); ++n)
            sum[intra_.at(n)] += step(n), frames[intra_.at(n)] += 1;
        out.pumping = frames[1] > 0 && frames[0] > 0 ? sum[1] / frames[1] - sum[0] / frames[0] : 0.0;
    }

  private:
    const core::MotionField& motion(std::int64_t n) const {
        return stage_.motion[static_cast<std::size_t>(n - first_)];
    }
    double step(std::int64_t n) const {
        return perceptual::change_along(motion(n), decoded_.at(n), decoded_.at(n - 1));
    }

    std::int64_t first_;
    const Stage& stage_;
    double bytes_ = 0, mse_ = 0, chroma_ = 0, ssim_ = 0, hvs_ = 0, count_ = 0;
    std::map<std::int64_t, core::Plane<std::uint8_t>> decoded_;
    std::map<std::int64_t, bool> intra_;
};

class Watching : public app::LoopObserver {
  public:
    Watching(LightJudge& light, CodingJudge& coding) : light_(light), coding_(coding) {}
    void lit(const app::LitFrame& frame) override {
        light_.lit(frame);
        if (pictures != nullptr) pictures->push_back(frame.picture);
    }
    void coded(const encoder::CodedPicture& picture) override { coding_.coded(picture); }

    std::vector<core::Picture>* pictures = nullptr;

  private:
    LightJudge& light_;
    CodingJudge& coding_;
};

Outcome cost_of(const app::RunStatistics& statistics, const renderer::Renderer& renderer) {
    const renderer::Statistics& s = statistics.rendering;
    Outcome out;
    for (const renderer::Pass pass :
         {renderer::Pass::punctual_lights, renderer::Pass::direct_tree, renderer::Pass::indirect_tree})
        out.gather_seconds += renderer.seconds(pass);
    out.preview_seconds = statistics.of(app::Stage::preview);
    out.shade_seconds = statistics.of(app::Stage::shade) + out.preview_seconds;
    out.tolerate_seconds = statistics.of(app::Stage::tolerate);
    out.rays = static_cast<double>(s.shadow_rays);
    const auto points = static_cast<double>(std::max<std::uint64_t>(1, s.gather_points));
    out.cut = static_cast<double>(s.direct_clusters + s.indirect_clusters) / points /
              static_cast<double>(std::max<std::size_t>(1, s.direct_points + s.indirect_points));
    out.capped = static_cast<double>(s.capped_points) / points;
    out.error_scale = s.mean_error_scale;
    return out;
}

Outcome run(const RenderJob& film, const Stage& stage, std::vector<core::Picture>* pictures) {
    LightJudge light(film, stage);
    CodingJudge coding(film, stage);
    Watching watching(light, coding);
    watching.pictures = pictures;
    renderer::Renderer renderer(*film.animation, film.rendering, film.plan);
    app::RunStatistics statistics;
    for (const app::Chunk& chunk : app::chunks_of(film.frames, film.coding.gop))
        app::render_chunk(film, renderer, chunk, watching, statistics, [] { return true; });
    statistics.rendering = renderer.statistics();
    Outcome out = cost_of(statistics, renderer);
    light.add_to(out);
    coding.add_to(out);
    return out;
}

}  // namespace

Outcome made(const RenderJob& film, const Stage& stage) {
    return run(film, stage, nullptr);
}

LitFilm::LitFilm(const RenderJob& film, const Stage& stage) : film_(film), stage_(stage) {
    lit_ = run(film, stage, &pictures_);
}

Outcome LitFilm::coded(int quantiser) const {
    CodingJudge judge(film_, stage_);
    RenderJob film = film_;
    film.coding.quantiser = quantiser;
    for (const app::Chunk& chunk : app::chunks_of(film.frames, film.coding.gop)) {
        const auto take = [&](const std::vector<encoder::CodedPicture>& pictures) {
            for (const encoder::CodedPicture& picture : pictures) judge.coded(picture);
        };
        app::RunStatistics statistics;
        app::PosedFrames posed(film);
        app::PictureCoder coder(film.film(), chunk, film.allocations, app::shots_of(*film.animation), statistics,
                                scene::traits_of(*film.animation).lights_change);
        for (std::int64_t n = chunk.first; n <= chunk.last; ++n) {
            const auto i = static_cast<std::size_t>(n - film.frames.first);
            const std::shared_ptr<const scene::Snapshot> world = posed.at(n);
            app::RenderedMotion motion(film, posed, stage_.visible[i], *world, statistics);
            const encoder::PicturePlan plan = coder.plan(n, world->cut_before, motion);
            take(coder.code(pictures_[i], plan, motion));
        }
        take(coder.flush());
    }
    Outcome out = lit_;
    judge.add_to(out);
    return out;
}

}  // namespace render2mpeg::bench
