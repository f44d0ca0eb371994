#include "encoder/mpeg2/checks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

bool is_count(std::int64_t n) {
    return n >= 0 && n <= most_pictures;
}

bool is_amount(double value) {
    return std::isfinite(value) && value >= 0;
}

bool is_positive(double value) {
    return std::isfinite(value) && value > 0;
}

bool is_type(PictureType type) {
    return type >= PictureType::intra && type <= PictureType::bidirectional;
}

/// Of macroblocks.
template <class T>
void check_map(const Settings& settings, const core::Plane<T>& map) {
    EXPECTS(map.width() == (settings.width + 15) / 16 && map.height() == (settings.height + 15) / 16);
}

void check_field(const Settings& settings, const core::MotionField& field, std::int64_t picture,
                 std::int64_t reference) {
    EXPECTS(field.picture == picture && field.reference == reference);
    EXPECTS(field.vector.width() == settings.width && field.vector.height() == settings.height);
    EXPECTS(field.kind.width() == settings.width && field.kind.height() == settings.height);
}

}  // namespace

void check_facts(std::int64_t number, const PictureFacts& facts) {
    EXPECTS(is_count(number) && is_count(facts.frames_left));
    EXPECTS(is_count(facts.left_in_chunk.value_or(0)));
    EXPECTS(is_positive(facts.quality_factor.value_or(1.0)) && is_amount(facts.motion_nonuniformity.value_or(0.0)));
    EXPECTS(std::all_of(facts.trial.begin(), facts.trial.end(), [](const FirstPassPicture& p) {
        return is_type(p.type) && p.quantiser >= 1 && p.quantiser <= 31 && is_amount(p.bits);
    }));
    if (!facts.allocation) return;
    EXPECTS(facts.allocation->quantiser >= 1 && facts.allocation->quantiser <= 31);
    EXPECTS(is_amount(facts.allocation->bits) && is_amount(facts.allocation->bits_left));
    EXPECTS(is_amount(facts.allocation->affordable));
    EXPECTS(is_type(facts.allocation->type.value_or(PictureType::intra)));
    EXPECTS(is_positive(facts.allocation->ratio.value_or(1.0)));
    EXPECTS(std::all_of(facts.allocation->left_by_type.begin(), facts.allocation->left_by_type.end(), is_amount));
}

void check_film(Codec codec, std::span<const FirstPassPicture> film) {
    std::vector<std::int64_t> numbers;
    for (const FirstPassPicture& picture : film) {
        numbers.push_back(picture.number);
        EXPECTS(is_count(picture.number) && is_type(picture.type));
        EXPECTS(is_positive(picture.quantiser));
        EXPECTS(codec != Codec::mpeg2 || (picture.quantiser >= 1 && picture.quantiser <= 31));
        EXPECTS(is_positive(picture.bits) && is_positive(picture.ratio.value_or(1.0)));
    }
    std::sort(numbers.begin(), numbers.end());
    EXPECTS(std::adjacent_find(numbers.begin(), numbers.end()) == numbers.end());
}

void check_pushed(const Settings& settings, const core::Picture& picture, const PicturePlan& plan,
                  std::span<const core::MotionField> motion, const Hints& hints) {
    const int chroma_width = (settings.width + 1) / 2, chroma_height = (settings.height + 1) / 2;
    EXPECTS(picture.number == plan.number);
    EXPECTS(picture.width() == settings.width && picture.height() == settings.height);
    EXPECTS(picture.cb.width() == chroma_width && picture.cb.height() == chroma_height);
    EXPECTS(picture.cr.width() == chroma_width && picture.cr.height() == chroma_height);

    EXPECTS(motion.empty() || motion.size() == plan.references.size());
    for (std::size_t i = 0; i < motion.size(); ++i) check_field(settings, motion[i], plan.number, plan.references[i]);
    if (hints.quantiser_factors) {
        check_map(settings, *hints.quantiser_factors);
        EXPECTS(std::all_of(hints.quantiser_factors->values().begin(), hints.quantiser_factors->values().end(),
                            [](float factor) { return std::isfinite(factor) && factor > 0; }));
    }
    if (hints.hidden) {
        check_map(settings, *hints.hidden);
        EXPECTS(std::all_of(hints.hidden->values().begin(), hints.hidden->values().end(), is_amount));
    }
    if (hints.innovation) {
        check_map(settings, *hints.innovation);
        EXPECTS(std::all_of(hints.innovation->values().begin(), hints.innovation->values().end(), is_amount));
    }
    if (hints.forced) check_map(settings, *hints.forced);
    if (!hints.onward) return;
    EXPECTS(plan.horizon.has_value());
    check_field(settings, *hints.onward, plan.number, *plan.horizon);
}

}  // namespace render2mpeg::encoder::mpeg2
