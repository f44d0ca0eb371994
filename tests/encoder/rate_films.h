#pragma once

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "film.h"
#include "rate_check.h"

/// Films with every kind of rate control, cut into chunks that are coded apart.
namespace render2mpeg::encoder::testing {

/// What is asked of one film.
struct RateCase {
    Settings settings;
    std::vector<std::int64_t> chunks;  ///< lengths
    std::vector<bool> cuts;            ///< per picture
    int content = 0;                   ///< 0 moving texture, 1 noise, 2 black, 3 a mixture that changes at cuts
    std::uint64_t seed = 0;

    std::string text() const {
        const RateControl& r = settings.rate_control;
        std::ostringstream out;
        out << "seed " << seed << ": " << settings.width << "x" << settings.height << " at " << settings.rate.name
            << ", cadence " << static_cast<int>(settings.cadence) << ", quantiser " << settings.quantiser << ", gop "
            << settings.gop << ", b " << settings.b_pictures << ", mode " << static_cast<int>(r.mode) << ", rate "
            << r.bit_rate << ", most " << r.max_rate << ", buffer " << r.buffer_bits << ", content " << content;
        return out.str();
    }
};

inline core::Picture picture_of(const RateCase& c, std::int64_t n) {
    const Settings& s = c.settings;
    std::uint64_t shot = 0;
    for (std::int64_t i = 0; i <= n; ++i) shot += c.cuts[static_cast<std::size_t>(i)] ? 1 : 0;
    const int content = c.content == 3 ? static_cast<int>((c.seed + shot) % 3) : c.content;
    if (content == 1) return noise(s.width, s.height, n, c.seed + 77 * static_cast<std::uint64_t>(n));
    if (content == 2) return paint(s.width, s.height, n, [](int plane, double, double) { return plane ? 128 : 16; });
    core::Picture picture = textured(s, n + 31 * static_cast<std::int64_t>(shot), {1.5, -0.5});
    picture.number = n;
    return picture;
}

/// Codes each chunk by an encoder of its own, as farms do, and joins them.
inline Film encode_chunks(const RateCase& c) {
    Film film{c.settings, {}};
    std::int64_t first = 0, all = static_cast<std::int64_t>(c.cuts.size());
    for (const std::int64_t length : c.chunks) {
        Encoder encoder(c.settings);
        const std::int64_t end = first + length;
        const auto keep = [&](std::vector<CodedPicture> pictures) {
            for (CodedPicture& p : pictures) film.coded.push_back(std::move(p));
        };
        for (std::int64_t n = first; n < end; ++n) {
            PictureFacts facts;
            facts.cut_before = c.cuts[static_cast<std::size_t>(n)];
            while (n + facts.frames_left + 1 < end && !c.cuts[static_cast<std::size_t>(n + facts.frames_left + 1)])
                ++facts.frames_left;
            facts.left_in_chunk = end - 1 - n;
            facts.last_chunk = end == all;
            const PicturePlan plan = encoder.plan(n, facts, n == first);
            keep(encoder.push(picture_of(c, n), plan, steady_motion(c.settings, plan, {-1.5f, 0.5f})));
        }
        keep(encoder.flush());
        first = end;
    }
    return film;
}

/// Any parameters; those that no rate can serve are refused by check(), and others taken.
inline RateCase random_case(std::uint64_t seed) {
    const auto random = [&](std::uint64_t what) { return core::uniform(seed, what, 0, 0); };
    const auto pick = [&](std::uint64_t what, int low, int high) {
        return low + std::min(high - low, static_cast<int>(random(what) * (high - low + 1)));
    };
    RateCase c;
    c.seed = seed;
    for (std::uint64_t attempt = 0;; ++attempt) {
        const std::uint64_t a = 100 * attempt;
        const bool large = random(a) < 0.05;
        Settings& s = c.settings;
        s = settings(pick(a + 1, 1, large ? 400 : 90), pick(a + 2, 1, large ? 300 : 90), pick(a + 3, 1, 31),
                     pick(a + 4, 1, 16), pick(a + 5, 1, 8), pick(a + 6, 0, 3));
        s.effort = random(a + 7) < 0.5 ? Effort::fast : Effort::quality;
        s.tune = random(a + 20) < 0.3 ? Tune::perceptual : Tune::psnr;
        const int cadence = pick(a + 8, 0, 5);
        s.cadence = cadence == 1                       ? Cadence::fields
                    : cadence == 2 && s.rate.code <= 2 ? Cadence::pulldown
                                                       : Cadence::frames;
        RateControl& r = s.rate_control;
        r.mode = static_cast<RateMode>(pick(a + 9, 0, 3));
        r.quality = 100 * random(a + 10);
        // From what nothing fits into to far more than needed, evenly in its logarithm.
        const double samples = s.width * s.height * s.rate.hertz.value();
        if (r.mode == RateMode::variable || r.mode == RateMode::constant)
            r.bit_rate = static_cast<std::int64_t>(400 + samples * std::exp2(-7 + 10 * random(a + 11)));
        if (r.mode != RateMode::constant && random(a + 12) < 0.6)
            r.max_rate = r.bit_rate > 0
                             ? static_cast<std::int64_t>(static_cast<double>(r.bit_rate) * (1 + 2 * random(a + 13)))
                             : static_cast<std::int64_t>(400 + samples * std::exp2(-7 + 10 * random(a + 13)));
        if (random(a + 14) < 0.6) r.buffer_bits = static_cast<std::int64_t>(16384 * std::exp2(7 * random(a + 15)));
        try {
            check(s);
        } catch (const core::Error&) {
            continue;
        }
        break;
    }
    // Whole GOPs but for the last chunk, as chunks are.
    const int chunks = pick(16, 1, 3), gops = std::max(1, 12 / c.settings.gop);
    std::int64_t all = 0;
    for (int i = 0; i < chunks; ++i) {
        const bool last = i == chunks - 1;
        c.chunks.push_back(last ? pick(17, 1, 14) : gops * c.settings.gop);
        all += c.chunks.back();
    }
    c.content = pick(18, 0, 3);
    for (std::int64_t n = 0; n < all; ++n)
        c.cuts.push_back(n > 0 && core::uniform(seed, 19, static_cast<std::uint64_t>(n), 0) < 0.08);
    return c;
}

/// What is wrong with the film as foreign eyes see it; empty: nothing.
inline std::string violations(const RateCase& c, const Film& film) {
    std::string wrong;
    try {
        const ReadStream stream = read_stream(film.bytes());
        if (stream.pictures.size() != film.coded.size()) return "pictures are missing";
        const bool constant = c.settings.rate_control.mode == RateMode::constant;
        wrong = check_stream(stream, constant);
        std::vector<std::size_t> starts = {0};
        for (const std::int64_t length : c.chunks) starts.push_back(starts.back() + static_cast<std::size_t>(length));
        if (wrong.empty()) wrong = check_reported(stream, film.coded, starts, declaration_of(c.settings), constant);
        Libavcodec decoder;
        for (const CodedPicture& coded : film.coded) decoder.push(coded.bytes);
        const std::vector<core::Picture> theirs = decoder.finish();
        if (theirs.size() != film.coded.size()) return "libavcodec finds other pictures";
        for (const CodedPicture& coded : film.coded)
            if (difference(coded.reconstruction, theirs[static_cast<std::size_t>(coded.plan.number)]).largest != 0)
                return "libavcodec decodes another picture " + std::to_string(coded.plan.number);
    } catch (const std::exception& error) {
        return error.what();
    }
    return wrong;
}

}  // namespace render2mpeg::encoder::testing
