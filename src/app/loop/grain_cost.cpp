#include "app/loop/grain_cost.h"

#include "app/loop/picture_coder.h"
#include "core/film_grain.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// chosen: a key picture and what comes behind it, for a second of coding at most; grain takes as much later.
constexpr std::size_t most_pictures = 12;

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

GrainCost::GrainCost(const Film& film, const Chunk& chunk)
    : film_(film),
      wanted_(film.coding.grain > 0 && chunk.first == film.frames.first &&
              !encoder::facts_of(film.coding.codec).master &&
              film.coding.rate_control.mode == encoder::RateMode::constant_quantiser) {}

void GrainCost::add(const core::Picture& picture) {
    if (wanted_ && pictures_.size() < most_pictures) pictures_.push_back(picture);
}

void GrainCost::measure(RunStatistics& statistics) const {
    if (pictures_.empty()) return;
    const StageTimer timer(statistics, Stage::encode);
    std::vector<core::Picture> plain = pictures_;
    for (core::Picture& picture : plain) core::take_grain(picture, encoder::grain_of_pictures(film_.coding));
    Film without = film_;
    without.coding.grain = 0;
    statistics.grain.pictures += static_cast<double>(plain.size());
    statistics.grain.with += bits_of(film_, pictures_);
    statistics.grain.without += bits_of(without, plain);
}

}  // namespace render2mpeg::app
