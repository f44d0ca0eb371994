#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/motion_field.h"
#include "core/picture.h"
#include "core/sampling.h"
#include "decoders.h"
#include "encoder/encoder.h"

/// Small films for the encoder's tests, and what decoders make of them.
namespace render2mpeg::encoder::testing {

inline core::FrameRate rate(int code) {
    return core::mpeg2_frame_rates()[static_cast<std::size_t>(code - 1)];
}

inline Settings settings(int width, int height, int quantiser = 4, int gop = 15, int rate_code = 3,
                         int b_pictures = 0) {
    Settings s;
    s.width = width;
    s.height = height;
    s.rate = rate(rate_code);
    s.quantiser = quantiser;
    s.gop = gop;
    s.b_pictures = b_pictures;
    return s;
}

/// A picture from code values as functions of luma positions; each plane gets the function's value for plane 0, 1, 2.
inline core::Picture paint(int width, int height, std::int64_t number,
                           const std::function<double(int plane, double x, double y)>& value) {
    core::Picture picture;
    picture.number = number;
    for (int plane = 0; plane < 3; ++plane) {
        const int shrink = plane == 0 ? 1 : 2;
        core::Plane<std::uint8_t> p((width + shrink - 1) / shrink, (height + shrink - 1) / shrink);
        for (int y = 0; y < p.height(); ++y)
            for (int x = 0; x < p.width(); ++x)
                p.at(x, y) =
                    static_cast<std::uint8_t>(std::clamp(std::lround(value(plane, x * shrink, y * shrink)), 0l, 255l));
        (plane == 0 ? picture.y : plane == 1 ? picture.cb : picture.cr) = std::move(p);
    }
    return picture;
}

/// White noise over all 256 code values, the same for the same seed.
inline core::Picture noise(int width, int height, std::int64_t number, std::uint64_t seed) {
    return paint(width, height, number, [=](int plane, double x, double y) {
        return 255.99 * core::uniform(seed, static_cast<std::uint64_t>(plane), static_cast<std::uint64_t>(x),
                                      static_cast<std::uint64_t>(y)) -
               0.5;
    });
}

/// A texture of several sines, without seams and band-limited: it may be sampled anywhere.
inline double texture(int plane, double x, double y) {
    const double detail =
        std::sin(0.71 * x + 0.13 * y) * std::sin(0.47 * y - 0.19 * x) + 0.6 * std::sin(0.23 * x + 0.31 * y);
    return plane == 0 ? 120 + 45 * detail + 12 * std::sin(0.05 * x) : 128 + 25 * std::sin(0.11 * x + 0.07 * y + plane);
}

/// Soft spots of all sizes from 8 pixels on, nowhere alike.
inline double clouds(int plane, double x, double y) {
    double value = 128;
    for (int octave = 0; octave < 3; ++octave) {
        const double size = 8 << octave, u = x / size + 100, v = y / size + 100;
        const auto corner = [&](double dx, double dy) {
            return core::uniform(static_cast<std::uint64_t>(octave), static_cast<std::uint64_t>(plane),
                                 static_cast<std::uint64_t>(std::floor(u) + dx),
                                 static_cast<std::uint64_t>(std::floor(v) + dy)) -
                   0.5;
        };
        const double a = u - std::floor(u), b = v - std::floor(v);
        value += 70 * ((1 - b) * ((1 - a) * corner(0, 0) + a * corner(1, 0)) +
                       b * ((1 - a) * corner(0, 1) + a * corner(1, 1)));
    }
    return value;
}

/// The texture, moved by `step` pixels per picture.
inline core::Picture textured(const Settings& s, std::int64_t n, glm::dvec2 step) {
    return paint(s.width, s.height, n, [&](int plane, double x, double y) {
        return texture(plane, x - step.x * static_cast<double>(n), y - step.y * static_cast<double>(n));
    });
}

/// Motion that is the same everywhere.
inline core::MotionField uniform_motion(int width, int height, std::int64_t picture, glm::vec2 v) {
    core::MotionField field;
    field.picture = picture;
    field.reference = picture - 1;
    field.vector = core::Plane<glm::vec2>(width, height, v);
    field.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
    return field;
}

/// Motion to each reference of a plan where everything moves by `step` pixels per picture.
inline std::vector<core::MotionField> steady_motion(const Settings& s, const PicturePlan& plan, glm::vec2 step) {
    std::vector<core::MotionField> fields;
    for (const std::int64_t reference : plan.references) {
        fields.push_back(
            uniform_motion(s.width, s.height, plan.number, step * static_cast<float>(reference - plan.number)));
        fields.back().reference = reference;
    }
    return fields;
}

struct Film {
    Settings settings;
    std::vector<CodedPicture> coded;

    std::vector<std::uint8_t> bytes() const {
        std::vector<std::uint8_t> all;
        for (const CodedPicture& c : coded) all.insert(all.end(), c.bytes.begin(), c.bytes.end());
        const std::vector<std::uint8_t> end = sequence_end();
        all.insert(all.end(), end.begin(), end.end());
        return all;
    }
};

using Paint = std::function<core::Picture(std::int64_t number)>;
using Motion = std::function<std::vector<core::MotionField>(const PicturePlan& plan)>;
inline std::vector<core::MotionField> no_motion(const PicturePlan&) {
    return {};
}

inline Film encode(const Settings& s, int count, const Paint& picture, const Motion& motion = no_motion) {
    Film film{s, {}};
    Encoder encoder(s);
    for (int n = 0; n < count; ++n) {
        const PicturePlan plan = encoder.plan(n, {.frames_left = count - 1 - n}, n == 0);
        const std::vector<core::MotionField> fields =
            plan.references.empty() ? std::vector<core::MotionField>{} : motion(plan);
        for (CodedPicture& coded : encoder.push(picture(n), plan, fields)) film.coded.push_back(std::move(coded));
    }
    for (CodedPicture& coded : encoder.flush()) film.coded.push_back(std::move(coded));
    return film;
}

/// Differences between two decoders' pictures in code values.
struct Difference {
    int largest = 0;
    double mean = 0;
};
inline Difference difference(const core::Picture& a, const core::Picture& b) {
    Difference d;
    double sum = 0, count = 0;
    for (const auto& [p, q] : {std::pair{&a.y, &b.y}, {&a.cb, &b.cb}, {&a.cr, &b.cr}})
        for (std::size_t i = 0; i < p->size(); ++i) {
            const int delta = std::abs(p->values()[i] - q->values()[i]);
            d.largest = std::max(d.largest, delta);
            sum += delta;
            count += 1;
        }
    d.mean = sum / count;
    return d;
}

/// Both foreign decoders return all pictures: libavcodec exactly our reconstruction, libmpeg2 the same but for the
/// rounding of its own transform, whose bound on the mean the caller gives.
inline Difference expect_decoders_agree(const Film& film, double libmpeg2_mean) {
    Libavcodec libavcodec;
    for (const CodedPicture& coded : film.coded) libavcodec.push(coded.bytes);
    const std::vector<core::Picture> theirs = libavcodec.finish();
    const std::vector<core::Picture> others = decode_with_libmpeg2(film.bytes());
    EXPECT_EQ(theirs.size(), film.coded.size());
    EXPECT_EQ(others.size(), film.coded.size());
    Difference worst;
    for (const CodedPicture& coded : film.coded) {
        const core::Picture& ours = coded.reconstruction;
        const auto i = static_cast<std::size_t>(coded.plan.number - film.coded[0].plan.number);
        if (i < theirs.size()) {
            const bool same_size = theirs[i].width() == ours.width() && theirs[i].height() == ours.height();
            EXPECT_TRUE(same_size);
            if (!same_size) return worst;
            EXPECT_EQ(difference(ours, theirs[i]).largest, 0) << "picture " << i << " as libavcodec decodes it";
        }
        if (i >= others.size() || others[i].width() != ours.width() || others[i].height() != ours.height()) continue;
        const Difference d = difference(ours, others[i]);
        EXPECT_LE(d.mean, libmpeg2_mean) << "picture " << i << " as libmpeg2 decodes it";
        worst.largest = std::max(worst.largest, d.largest);
        worst.mean = std::max(worst.mean, d.mean);
    }
    return worst;
}

}  // namespace render2mpeg::encoder::testing
