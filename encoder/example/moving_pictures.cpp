// Encodes pictures that a program makes itself, with their exact motion: a patterned disc rolls over a patterned
// ground. Usage: moving_pictures OUT.m2v [FRAMES]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "core/motion_field.h"
#include "core/picture.h"
#include "encoder/capabilities.h"
#include "encoder/encoder.h"

namespace {

namespace core = render2mpeg::core;
namespace encoder = render2mpeg::encoder;

constexpr int width = 640, height = 480;
constexpr double radius = 90;

/// Where the disc is in picture n: it rolls, so that its rim does not slip.
struct Disc {
    glm::dvec2 centre;
    double angle;

    explicit Disc(std::int64_t n)
        : centre(100 + 3.3 * static_cast<double>(n), 300), angle(3.3 / radius * static_cast<double>(n)) {}
    bool covers(glm::dvec2 p) const { return glm::length(p - centre) < radius; }
    /// A place on the picture in the disc's own coordinates, and back.
    glm::dvec2 own(glm::dvec2 p) const { return turned(p - centre, -angle); }
    glm::dvec2 shown(glm::dvec2 own) const { return centre + turned(own, angle); }

    static glm::dvec2 turned(glm::dvec2 v, double by) {
        return {std::cos(by) * v.x - std::sin(by) * v.y, std::sin(by) * v.x + std::cos(by) * v.y};
    }
};

double pattern(glm::dvec2 p) {
    return std::sin(0.31 * p.x + 0.11 * p.y) * std::sin(0.27 * p.y - 0.07 * p.x);
}

/// Luma 16..235 and chroma 16..240 of a place on picture n. `plane`: Y', Cb, Cr.
std::uint8_t value_at(int plane, glm::dvec2 p, const Disc& disc) {
    const bool on_disc = disc.covers(p);
    const double v = on_disc ? pattern(1.3 * disc.own(p)) : pattern(0.6 * p);
    if (plane == 0) return static_cast<std::uint8_t>(std::lround(on_disc ? 150 + 60 * v : 100 + 40 * v));
    return static_cast<std::uint8_t>(on_disc ? (plane == 1 ? 100 : 170) : 128);
}

core::Picture picture(std::int64_t n) {
    const Disc disc(n);
    core::Picture result;
    result.number = n;
    result.y = core::Plane<std::uint8_t>(width, height);
    result.cb = result.cr = core::Plane<std::uint8_t>(width / 2, height / 2);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) result.y.at(x, y) = value_at(0, {x + 0.5, y + 0.5}, disc);
    // MPEG-2's chroma lies on the even luma columns, and between two rows.
    for (int y = 0; y < height / 2; ++y)
        for (int x = 0; x < width / 2; ++x) {
            result.cb.at(x, y) = value_at(1, {2 * x + 0.5, 2 * y + 1.0}, disc);
            result.cr.at(x, y) = value_at(2, {2 * x + 0.5, 2 * y + 1.0}, disc);
        }
    return result;
}

/// Where each pixel's point is in the reference, minus where it is here: pixels, y down. `none` where it is not seen.
core::MotionField motion(std::int64_t n, std::int64_t reference) {
    const Disc here(n), there(reference);
    core::MotionField field;
    field.picture = n;
    field.reference = reference;
    field.vector = core::Plane<glm::vec2>(width, height, glm::vec2(0));
    field.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::dvec2 p{x + 0.5, y + 0.5};
            if (here.covers(p))
                field.vector.at(x, y) = glm::vec2(there.shown(here.own(p)) - p);
            else if (there.covers(p))
                field.kind.at(x, y) = core::PixelClass::none;  // the ground is hidden there
        }
    return field;
}

void run(const char* file, int frames) {
    encoder::Settings settings;
    settings.width = width;
    settings.height = height;
    settings.rate = core::frame_rate_from("25");
    settings.quantiser = 5;
    encoder::check(settings);
    std::printf("%s Profile at %s Level\n", encoder::capabilities().profile, encoder::level_of(settings).name);

    encoder::Encoder coder(settings);
    std::ofstream stream(file, std::ios::binary);
    std::size_t bytes = 0;
    const auto write = [&](const std::vector<encoder::CodedPicture>& pictures) {
        for (const encoder::CodedPicture& coded : pictures) {
            stream.write(reinterpret_cast<const char*>(coded.bytes.data()),
                         static_cast<std::streamsize>(coded.bytes.size()));
            bytes += coded.bytes.size();
        }
    };
    for (std::int64_t n = 0; n < frames; ++n) {
        // The plan says which pictures this one refers to: give the motion to each.
        const encoder::PicturePlan plan = coder.plan(n, {.frames_left = frames - 1 - n}, n == 0);
        std::vector<core::MotionField> fields;
        for (const std::int64_t reference : plan.references) fields.push_back(motion(n, reference));
        write(coder.push(picture(n), plan, fields));
    }
    write(coder.flush());
    const std::vector<std::uint8_t> end = encoder::sequence_end();
    stream.write(reinterpret_cast<const char*>(end.data()), static_cast<std::streamsize>(end.size()));
    stream.close();
    if (!stream) throw core::Error("writing", file, "the file cannot be written");
    std::printf("%d pictures, %zu bytes\n", frames, bytes + end.size());
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fputs("usage: moving_pictures OUT.m2v [FRAMES]\n", stderr);
        return 2;
    }
    run(argv[1], argc > 2 ? std::max(1, std::atoi(argv[2])) : 50);
    return 0;
} catch (const core::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
