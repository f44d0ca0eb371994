#include "encoder/capabilities.h"

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/motion/candidates.h"
#include "encoder/mpeg2/motion/motion_estimation.h"

namespace render2mpeg::encoder {
namespace {

/// Vectors of f_code f reach from -8 * 2^(f-1) to just below 8 * 2^(f-1) pixels. [H262, table 7-8]
constexpr int reach(int f_code) {
    return 8 << (f_code - 1);
}

LevelLimits limits_of(const mpeg2::Level& level) {
    return {level.name,
            level.indication,
            level.width,
            level.height,
            level.hertz,
            level.samples,
            level.bit_rate,
            level.buffer_bits,
            reach(level.horizontal_f_code),
            reach(mpeg2::vertical_f_code_limit)};
}

}  // namespace

Capabilities capabilities() {
    Capabilities c;
    c.profile = "Main";
    for (const mpeg2::Level& level : mpeg2::all_levels()) c.levels.push_back(limits_of(level));
    c.quantiser_min = 1;
    c.quantiser_max = 31;
    c.most_b_pictures = 3;
    c.fields_per_picture = 2;
    c.candidates = static_cast<int>(mpeg2::Candidates{}.vector.size());
    c.most_block_evaluations = mpeg2::evaluation_limit;
    c.vector_step = 0.5;
    c.quantiser_factors = c.forced_macroblocks = true;
    c.interlaced = false;
    c.efforts = {Effort::fast, Effort::quality};
    c.tunes = {Tune::psnr, Tune::perceptual};
    c.cadences = {Cadence::frames, Cadence::fields, Cadence::pulldown};
    c.rate_modes = {RateMode::constant_quantiser, RateMode::constant_quality, RateMode::variable, RateMode::constant};
    return c;
}

LevelLimits level_of(const Settings& settings) {
    return limits_of(mpeg2::level_for(settings));
}

}  // namespace render2mpeg::encoder
