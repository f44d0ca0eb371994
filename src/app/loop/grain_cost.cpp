#include "app/loop/grain_cost.h"

#include <algorithm>

#include "app/loop/picture_coder.h"
#include "core/film_grain.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// chosen: a key picture and what comes behind it, of large ones as many as have so many pixels, and two at least;
/// grain takes as much later.
constexpr std::size_t most_pictures = 12, least_pictures = 2, most_pixels = most_pictures * 1280 * 720;

class NoMotion : public Motion {
    std::optional<core::MotionField> find(std::int64_t) override { return {}; }
};

double bits_of(const Film& film, const std::vector<core::Picture>& pictures) {
    encoder::LookAhead ahead(film.coding.width, film.coding.height, film.coding.b_pictures);
    for (const core::Picture& picture : pictures) ahead.add(picture);
    ahead.end();
    RunStatistics statistics;
    PictureCoder coder(film, {0, pictures.front().number, pictures.back().number}, {}, {}, statistics, false, &ahead);
    double bytes = 0;
    const auto count = [&](const std::vector<encoder::CodedPicture>& coded) {
        for (const encoder::CodedPicture& picture : coded) bytes += static_cast<double>(picture.bytes.size());
    };
    for (const core::Picture& picture : pictures) {
        NoMotion none;
        const encoder::PicturePlan plan = coder.plan(picture.number, ahead.cut_before(picture.number), none);
        count(coder.code(picture, plan, none));
    }
    count(coder.flush());
    return 8 * bytes;
}

}  // namespace

std::size_t grain_pictures(const Film& film) {
    const bool constant = film.coding.rate_control.mode == encoder::RateMode::constant_quantiser;
    if (film.coding.grain <= 0 || !constant || encoder::facts_of(film.coding.codec).master) return 0;
    const auto pixels = static_cast<std::size_t>(film.coding.width) * static_cast<std::size_t>(film.coding.height);
    return std::clamp(most_pixels / std::max<std::size_t>(pixels, 1), least_pictures, most_pictures);
}

GrainCost::GrainCost(const Film& film, const Chunk& chunk)
    : film_(film), wanted_(chunk.first == film.frames.first ? grain_pictures(film) : 0) {}

void GrainCost::add(const core::Picture& picture) {
    if (pictures_.size() < wanted_) pictures_.push_back(picture);
}

void GrainCost::measure(RunStatistics& statistics) {
    if (pictures_.empty()) return;
    const StageTimer timer(statistics, Stage::encode);
    statistics.grain.pictures += static_cast<double>(pictures_.size());
    statistics.grain.with += bits_of(film_, pictures_);
    for (core::Picture& picture : pictures_) core::take_grain(picture, encoder::grain_of_pictures(film_.coding));
    Film without = film_;
    without.coding.grain = 0;
    statistics.grain.without += bits_of(without, pictures_);
    pictures_.clear();
}

}  // namespace render2mpeg::app
