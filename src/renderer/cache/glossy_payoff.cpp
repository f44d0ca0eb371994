#include "renderer/cache/glossy_payoff.h"

namespace render2mpeg::renderer {
namespace {

/// Share of the points that records must serve: those that ask in vain are gathered in worse company, and asking takes
/// its time. chosen: 0.3, where both take the same time (docs/fits/records.md).
constexpr double least_served = 0.3;

/// Frames for which a material that was served too seldom takes no records. chosen: 14, so that its trials, of two
/// frames, cost an eighth of what they show to be too much; not tuned.
constexpr int rest = 14;

}  // namespace

void GlossyPayoff::note(std::uint32_t material, std::uint64_t asked, std::uint64_t served) {
    if (material >= payoffs_.size()) payoffs_.resize(material + std::size_t{1});
    payoffs_[material].asked_now += asked;
    payoffs_[material].served_now += served;
}

void GlossyPayoff::judge() {
    for (Payoff& t : payoffs_) {
        if (t.rests > 0) {
            --t.rests;
            continue;
        }
        if (t.asked_now == 0) continue;
        // The first frame finds no records of frames before it, and tells nothing of later ones.
        if (t.frames++ > 0) {
            t.asked = 0.5 * t.asked + static_cast<double>(t.asked_now);
            t.served = 0.5 * t.served + static_cast<double>(t.served_now);
            if (t.served < least_served * t.asked) t = {.rests = rest};
        }
        t.asked_now = t.served_now = 0;
    }
}

}  // namespace render2mpeg::renderer
