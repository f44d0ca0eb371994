#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "film.h"
#include "rate_check.h"

/// Pictures and hints that no renderer would give: whatever is lawful decodes to the reconstruction, bit for bit.
namespace render2mpeg::encoder::testing {
namespace {

/// Numbers from a seed, one after the other.
class RandomChoice {
  public:
    explicit RandomChoice(std::uint64_t seed) : seed_(seed) {}
    double next() { return core::uniform(seed_, 7, n_++, 0); }
    int pick(int low, int high) { return low + std::min(high - low, static_cast<int>(next() * (high - low + 1))); }

  private:
    std::uint64_t seed_, n_ = 0;
};

/// Blocks that drive coefficients to their ends, noise, flats and edges, mixed anew in every picture.
core::Picture wild_picture(const Settings& s, std::int64_t n, std::uint64_t seed) {
    const core::Picture grain = noise(s.width, s.height, n, seed + 1000 * static_cast<std::uint64_t>(n));
    core::Picture picture = grain;
    core::Plane<std::uint8_t>* const planes[] = {&picture.y, &picture.cb, &picture.cr};
    for (core::Plane<std::uint8_t>* plane : planes)
        for (int y = 0; y < plane->height(); ++y)
            for (int x = 0; x < plane->width(); ++x) {
                const auto block = static_cast<std::uint64_t>(y / 8 * 1000 + x / 8);
                const int kind = static_cast<int>(6 * core::uniform(seed, block, static_cast<std::uint64_t>(n) / 2, 1));
                std::uint8_t& v = plane->at(x, y);
                if (kind == 0) v = static_cast<std::uint8_t>(v < 128 ? 0 : 255);
                if (kind == 1) v = static_cast<std::uint8_t>((x + y) % 2 == 0 ? 0 : 255);
                if (kind == 2) v = static_cast<std::uint8_t>(block % 2 == 0 ? 0 : 255);
                if (kind == 3) v = static_cast<std::uint8_t>(x % 8 < 4 ? 255 : 0);
                if (kind == 4) v = static_cast<std::uint8_t>(128 + static_cast<int>(v) / 64);
            }
    return picture;
}

/// Vectors of every length, far out of the picture, no numbers; classes at random.
core::MotionField far_motion(const Settings& s, std::int64_t n, std::int64_t reference, RandomChoice& dice) {
    core::MotionField field = uniform_motion(s.width, s.height, n, {0, 0});
    field.reference = reference;
    const double reach = std::exp2(dice.pick(0, 13));
    for (int y = 0; y < s.height; ++y)
        for (int x = 0; x < s.width; ++x) {
            if ((x % 16 != 0 || y % 16 != 0) && dice.pick(0, 40) != 0) {  // mostly like a neighbour
                field.vector.at(x, y) = x % 16 != 0 ? field.vector.at(x - 1, y) : field.vector.at(x, y - 1);
                continue;
            }
            field.vector.at(x, y) = {static_cast<float>(reach * (2 * dice.next() - 1)),
                                     static_cast<float>(reach * (2 * dice.next() - 1))};
            const int odd = dice.pick(0, 60);
            if (odd == 0) field.vector.at(x, y).x = std::nanf("");
            if (odd == 1) field.vector.at(x, y).y = -std::numeric_limits<float>::infinity();
            if (odd == 2) field.vector.at(x, y) = {3e38f, -3e38f};
            if (odd < 8) field.kind.at(x, y) = static_cast<core::PixelClass>(dice.pick(0, 3));
        }
    return field;
}

Settings wild_settings(RandomChoice& dice) {
    Settings s = settings(dice.pick(1, 100), dice.pick(1, 100), dice.pick(0, 2) == 0 ? 1 : dice.pick(1, 31),
                          dice.pick(1, 9), dice.pick(1, 8), dice.pick(0, 3));
    s.effort = dice.pick(0, 1) == 0 ? Effort::fast : Effort::quality;
    s.tune = dice.pick(0, 2) == 0 ? Tune::perceptual : Tune::psnr;
    s.cadence = dice.pick(0, 2) == 0 ? Cadence::fields : Cadence::frames;
    return s;
}

Film wild_film(const Settings& s, int count, std::uint64_t seed, RandomChoice& dice) {
    Film film{s, {}};
    Encoder encoder(s);
    const auto keep = [&](std::vector<CodedPicture> pictures) {
        for (CodedPicture& p : pictures) film.coded.push_back(std::move(p));
    };
    for (int n = 0; n < count; ++n) {
        const PicturePlan plan = encoder.plan(n, {.frames_left = count - 1 - n}, n == 0);
        std::vector<core::MotionField> motion;
        for (const std::int64_t reference : plan.references) motion.push_back(far_motion(s, n, reference, dice));
        core::MotionField onward;
        if (plan.horizon) onward = far_motion(s, n, *plan.horizon, dice);
        const Hints hints{plan.horizon ? &onward : nullptr};
        keep(encoder.push(wild_picture(s, n, seed), plan,
                          dice.pick(0, 4) == 0 ? std::vector<core::MotionField>{} : motion, hints));
    }
    keep(encoder.flush());
    return film;
}

/// Macroblocks whose vectors lie on the border of what the picture allows.
int at_the_edge(const Film& film) {
    int count = 0;
    const int rows = mpeg2::macroblock_rows(film.settings), columns = (film.settings.width + 15) / 16;
    for (const CodedPicture& coded : film.coded)
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column) {
                const MacroblockRecord& m = coded.macroblocks.at(column, row);
                const mpeg2::VectorRange range = mpeg2::vector_range(column, row, columns, rows, 8, 5);
                EXPECT_TRUE(range.contains({m.motion_x, m.motion_y}));
                EXPECT_TRUE(range.contains({m.backward_x, m.backward_y}));
                count += m.forward && (m.motion_x == range.low_x || m.motion_x == range.high_x) && m.motion_x != 0;
            }
    return count;
}

TEST(HardCases, AnyPicturesWithAnyHintsDecodeToTheReconstruction) {
    int edges = 0, finest = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        RandomChoice dice(seed);
        const Settings s = wild_settings(dice);
        const Film film = wild_film(s, 5, seed, dice);
        // libmpeg2 rounds otherwise; pictures of black and white drift apart by more than others.
        expect_decoders_agree(film, 2.0);
        EXPECT_EQ(check_stream(read_stream(film.bytes()), false), "") << "seed " << seed;
        edges += at_the_edge(film);
        finest += s.quantiser == 1 ? 1 : 0;
        if (HasFailure())
            FAIL() << "seed " << seed << ": " << s.width << "x" << s.height << ", quantiser " << s.quantiser;
    }
    EXPECT_GT(edges, 5);
    EXPECT_GT(finest, 10);
}

TEST(HardCases, TheLongestVectorsThatALevelAllowsAreUsedAndDecode) {
    // A stripe jumps across the widest picture; another falls by the most that vertical vectors reach.
    struct Case {
        int width, height;
        glm::vec2 step;
    };
    for (const Case& c :
         {Case{1920, 48, {1840, 0}}, {720, 48, {-700, 0}}, {48, 288, {0, 128}}, {48, 288, {0, -127.5f}}}) {
        const Settings s = settings(c.width, c.height, 2, 2);
        const glm::vec2 step = c.step;
        const glm::dvec2 moved(step);
        const Film film = encode(
            s, 2, [&](std::int64_t n) { return textured(s, n, moved); },
            [&](const PicturePlan& plan) { return steady_motion(s, plan, step); });
        expect_decoders_agree(film, 1.0);
        EXPECT_EQ(check_stream(read_stream(film.bytes()), false), "");
        int taken = 0;
        for (const MacroblockRecord& m : film.coded[1].macroblocks.values())
            taken += !m.intra && m.motion_x == std::lround(-2 * step.x) && m.motion_y == std::lround(-2 * step.y);
        EXPECT_GE(taken, 3) << step.x << ", " << step.y;
    }
}

TEST(HardCases, EverySizeClassDecodes) {
    // Every remainder of a macroblock and of its chroma, both ways.
    for (int size = 1; size <= 33; ++size) {
        RandomChoice dice(static_cast<std::uint64_t>(size));
        const Settings s = settings(size, 34 - size, 3, 3, 3, 1);
        expect_decoders_agree(wild_film(s, 3, 5, dice), 2.0);
    }
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
