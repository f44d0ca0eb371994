#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/error.h"
#include "encoder/encoder.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "tests/encoder/decoders.h"

namespace render2mpeg::fuzz {
namespace {

encoder::Settings settings_from(Numbers& numbers) {
    encoder::Settings s;
    s.width = numbers.pick(1, 64);
    s.height = numbers.pick(1, 64);
    s.rate = core::mpeg2_frame_rates()[static_cast<std::size_t>(numbers.pick(0, 7))];
    s.quantiser = numbers.pick(1, 31);
    s.gop = numbers.pick(1, 12);
    s.b_pictures = numbers.pick(0, 3);
    s.effort = static_cast<encoder::Effort>(numbers.pick(0, 1));
    s.tune = static_cast<encoder::Tune>(numbers.pick(0, 1));
    s.cadence = static_cast<encoder::Cadence>(numbers.pick(0, 1));
    s.rate_control.mode = static_cast<encoder::RateMode>(numbers.pick(0, 3));
    s.rate_control.quality = numbers.pick(0, 100);
    if (s.rate_control.mode >= encoder::RateMode::variable)
        s.rate_control.bit_rate = 100 + numbers.word() % 100'000'000;
    return s;
}

/// Patches of one value, and of noise that the input's bytes begin.
core::Picture picture_from(Numbers& numbers, const encoder::Settings& s, std::int64_t n) {
    core::Picture picture;
    picture.number = n;
    picture.y = core::Plane<std::uint8_t>(s.width, s.height);
    picture.cb = picture.cr = core::Plane<std::uint8_t>((s.width + 1) / 2, (s.height + 1) / 2);
    for (core::Plane<std::uint8_t>* plane : {&picture.y, &picture.cb, &picture.cr}) {
        std::uint32_t state = numbers.word() | 1u;
        const bool flat = numbers.pick(0, 2) == 0, extreme = numbers.pick(0, 1) == 0;
        for (std::uint8_t& value : plane->values()) {
            if (!flat) state = state * 1664525u + 1013904223u;
            value = static_cast<std::uint8_t>(state >> 24);
            if (extreme) value = value < 128 ? 0 : 255;
        }
    }
    return picture;
}

core::MotionField motion_from(Numbers& numbers, const encoder::Settings& s, std::int64_t n, std::int64_t reference) {
    core::MotionField field;
    field.picture = n;
    field.reference = reference;
    field.vector = core::Plane<glm::vec2>(s.width, s.height);
    field.kind = core::Plane<core::PixelClass>(s.width, s.height, core::PixelClass::surface);
    glm::vec2 v{0};
    for (std::size_t i = 0; i < field.vector.size(); ++i) {
        if (i % 37 == 0) {
            const int kind = numbers.pick(0, 7);
            v = kind == 0 ? glm::vec2(numbers.any_float(), numbers.any_float())
                          : glm::vec2(0.5f * static_cast<float>(numbers.pick(-127, 127)), numbers.pick(-64, 64));
            if (kind == 1) field.kind.values()[i] = static_cast<core::PixelClass>(numbers.pick(0, 3));
        }
        field.vector.values()[i] = v;
    }
    return field;
}

/// Maps of what macroblocks ask for: lawful whatever the bytes say.
struct Demands {
    Demands(Numbers& numbers, const encoder::Settings& s)
        : factors((s.width + 15) / 16, (s.height + 15) / 16, 1.0f),
          forced((s.width + 15) / 16, (s.height + 15) / 16, encoder::Force::none),
          with_factors(numbers.pick(0, 1) > 0),
          with_forced(numbers.pick(0, 1) > 0) {
        for (float& factor : factors.values()) {
            const float any = std::abs(numbers.any_float());
            factor = std::isfinite(any) && any > 0 ? any : 1.0f;
        }
        for (encoder::Force& force : forced.values()) force = static_cast<encoder::Force>(numbers.pick(0, 2));
    }
    core::Plane<float> factors;
    core::Plane<encoder::Force> forced;
    bool with_factors, with_forced;
};

bool begins(const core::Error& error, std::initializer_list<std::string_view> beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [&](std::string_view words) { return std::string_view(error.what()).starts_with(words); });
}

/// Whether check() takes the settings. All that it may refuse of what settings_from() makes: a size or rate that no
/// level has, repeated fields at a rate that has none, and rates and buffers in which nothing fits.
bool is_lawful(const encoder::Settings& s) {
    try {
        encoder::check(s);
        return true;
    } catch (const core::Error& error) {
        if (begins(error, {"bit rate ", "highest bit rate ", "VBV buffer ", "frame rate ", "size "})) return false;
        throw std::logic_error(std::string("settings are refused for what they are not: ") + error.what());
    }
}

/// The plan of a picture, the first of a chunk where n is 0; none where a chunk of this length cannot be coded in its
/// rate and buffer, which is all that may be refused, and at its first picture only.
std::optional<encoder::PicturePlan> plan_or_refusal(encoder::Encoder& coder, int n,
                                                    const encoder::PictureFacts& facts) {
    try {
        return coder.plan(n, facts, n == 0);
    } catch (const core::Error& error) {
        if (n == 0 && begins(error, {"bit rate "}) &&
            std::string_view(error.what()).find(": a chunk of ") != std::string_view::npos)
            return std::nullopt;
        throw std::logic_error(std::string("a picture is refused: ") + error.what());
    }
}

void expect_decodes(const std::vector<encoder::CodedPicture>& coded) {
    encoder::testing::Libavcodec decoder;
    for (const encoder::CodedPicture& picture : coded) decoder.push(picture.bytes);
    const std::vector<core::Picture> shown = decoder.finish();
    if (shown.size() != coded.size()) throw std::logic_error("pictures are missing in the decoded film");
    const auto same = [](const core::Plane<std::uint8_t>& a, const core::Plane<std::uint8_t>& b) {
        return std::ranges::equal(a.values(), b.values());
    };
    for (const encoder::CodedPicture& picture : coded) {
        const core::Picture& there = shown.at(static_cast<std::size_t>(picture.plan.number));
        const core::Picture& meant = picture.reconstruction;
        if (!same(there.y, meant.y) || !same(there.cb, meant.cb) || !same(there.cr, meant.cr))
            throw std::logic_error("a picture does not decode to its reconstruction");
    }
}

}  // namespace

bool hints(Input input) {
    Numbers numbers(input);
    const encoder::Settings s = settings_from(numbers);
    const int count = numbers.pick(1, 8);
    const bool promises = numbers.pick(0, 3) > 0;
    std::vector<encoder::CodedPicture> coded;
    const auto keep = [&](std::vector<encoder::CodedPicture> pictures) {
        for (encoder::CodedPicture& picture : pictures) coded.push_back(std::move(picture));
    };
    if (!is_lawful(s)) return false;
    encoder::Encoder coder(s);
    for (int n = 0; n < count; ++n) {
        encoder::PictureFacts facts;
        facts.frames_left = promises ? count - 1 - n : 0;
        facts.left_in_chunk = count - 1 - n;
        facts.last_chunk = true;
        facts.quality_factor = numbers.pick(1, 400) / 100.0;
        const std::optional<encoder::PicturePlan> plan = plan_or_refusal(coder, n, facts);
        if (!plan) return false;
        std::vector<core::MotionField> motion;
        for (const std::int64_t reference : plan->references) motion.push_back(motion_from(numbers, s, n, reference));
        if (numbers.pick(0, 3) == 0) motion.clear();
        core::MotionField onward;
        if (plan->horizon) onward = motion_from(numbers, s, n, *plan->horizon);
        const Demands demands(numbers, s);
        const core::Plane<float>* const factors = demands.with_factors ? &demands.factors : nullptr;
        keep(coder.push(picture_from(numbers, s, n), *plan, motion,
                        {plan->horizon ? &onward : nullptr, factors, factors, factors,
                         demands.with_forced ? &demands.forced : nullptr}));
    }
    keep(coder.flush());
    expect_decodes(coded);
    return true;
}

}  // namespace render2mpeg::fuzz
