#include "encoder/rate_search.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace render2mpeg::encoder {

RateSearch::RateSearch(double near, int most_tries) : near_(near), most_tries_(most_tries) {
    EXPECTS(near >= 0 && most_tries > 0);
}

RateSearch RateSearch::onwards(double near, int most_tries) const {
    RateSearch next(near, most_tries);
    next.factor_ = factor_;
    next.slope_ = slope_;
    return next;
}

double RateSearch::factor() const {
    return std::exp(factor_);
}

bool RateSearch::try_ratio(double ratio) {
    EXPECTS(ratio > 0);
    const double excess = std::log(ratio);
    ++tries_;
    alike_ = last_ && excess == last_->excess ? alike_ + 1 : 0;
    if (last_ && excess != last_->excess)
        slope_ = std::clamp((last_->excess - excess) / (factor_ - last_->factor), 0.2, 4.0);
    const bool nearer = std::abs(excess) < closest_;
    closest_ = std::min(closest_, std::abs(excess));
    // An end that stays while the other one moves twice counts half.
    std::optional<Tried>& other = excess > 0 ? below_ : above_;
    if (last_ && (excess > 0) == (last_->excess > 0) && other) other->excess /= 2;
    (excess > 0 ? above_ : below_) = last_ = {factor_, excess};
    // Whole quantisers may ask for longer steps than the slope says.
    if (above_ && below_)
        factor_ = std::lerp(above_->factor, below_->factor,
                            std::clamp(above_->excess / (above_->excess - below_->excess), 0.1, 0.9));
    else
        factor_ += excess / slope_ * (1 << alike_);
    return nearer;
}

bool RateSearch::goes_on() const {
    // Thrice the same is the scale's end, or its next step's.
    constexpr int most_alike = 2;
    return closest_ > near_ && tries_ < most_tries_ && alike_ < most_alike;
}

}  // namespace render2mpeg::encoder
