#include "encoder/mpeg2/picture/fitting.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encoder/mpeg2/picture/minimal_picture.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// The next quantiser for a picture that came to `bits`. Bits fall about as 1 / quantiser; a tenth more than needed
/// spares most third codings, and the growth with each try makes sure of an end.
int coarser(int quantiser, std::int64_t bits, std::int64_t most_bits, int tries) {
    const double ratio = static_cast<double>(bits) / static_cast<double>(std::max<std::int64_t>(1, most_bits));
    const double wanted = std::min(31.0, quantiser * ratio * (1.0 + 0.1 * tries));
    return std::clamp(static_cast<int>(std::ceil(wanted)), quantiser + 1, 31);
}

}  // namespace

std::int64_t bits_of(const PictureResult& picture) {
    return 8 * static_cast<std::int64_t>(picture.bytes.size());
}

Fitted code_within(const PictureTask& task, const Level& level, std::int64_t most_bits) {
    PictureTask trial = task;
    Fitted fitted;
    std::uint64_t evaluations = 0;
    for (;; ++fitted.tries) {
        fitted.picture = code_picture(trial, level);
        fitted.picture.evaluations += evaluations;
        evaluations = fitted.picture.evaluations;
        fitted.quantiser = trial.quantiser;
        const std::int64_t bits = bits_of(fitted.picture);
        if (bits <= most_bits) return fitted;
        if (trial.quantiser < 31) {
            trial.quantiser = coarser(trial.quantiser, bits, most_bits, fitted.tries);
            continue;
        }
        // Let bits weigh more against distortion: detail, then motion, then all but skipping goes.
        // chosen: by 8, up to 512 times; of noise at 64x64 that leaves 1 / 4 of the bits of quantiser 31.
        if (trial.bit_weight > 100) break;
        trial.bit_weight *= 8;
        trial.quantiser_factors = nullptr;
        trial.forced = nullptr;
    }
    fitted.picture = minimal_picture(task);
    fitted.picture.evaluations = evaluations;
    fitted.minimal = true;
    ++fitted.tries;
    EXPECTS(bits_of(fitted.picture) <= most_bits);
    return fitted;
}

Fitted again(const Fitted& first, Fitted second) {
    second.tries += first.tries;
    second.picture.evaluations += first.picture.evaluations;
    return second;
}

}  // namespace render2mpeg::encoder::mpeg2
