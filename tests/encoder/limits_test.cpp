#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/macroblock/slice_writing.h"
#include "encoder/mpeg2/picture/fitting.h"
#include "film.h"

/// Limits that hold to the bit: macroblocks, evaluations.
namespace render2mpeg::encoder::mpeg2 {
namespace {

using encoder::testing::noise;
using encoder::testing::settings;

Frame noisy(int columns, int rows, std::uint64_t seed) {
    Frame frame(columns, rows);
    pad(noise(columns * 16, rows * 16, 0, seed), frame);
    return frame;
}

/// The most bits that vectors can grow by where the picture's f_codes turn out smaller than those decided with.
int growth(int decided, int written) {
    const int reach = 16 << (written - 1);
    int most = 0;
    for (int difference = 1 - 2 * reach; difference < 2 * reach; ++difference)
        most = std::max(most, component_bits(difference, written) - component_bits(difference, decided));
    return most;
}

TEST(MacroblockLimit, SmallerFCodesMakeComponentsLongerByAtMostTheMargin) {
    int most = 0;
    for (int decided = 1; decided <= 9; ++decided)
        for (int written = 1; written <= decided; ++written) most = std::max(most, growth(decided, written));
    EXPECT_EQ(most, f_code_margin);
}

/// The jump of a macroblock's vectors: the most that f_code 1 can say, from one macroblock to the next.
Vector jump(int column, int row, const Frame& frame) {
    const int v = column % 2 == 0 ? -8 : 7;
    return vector_range(column, row, frame.columns(), frame.rows(), 1, 1).clamp(v, v);
}

/// What these vectors predict, and noise upon it that is the louder the farther right.
Frame predicted_and_louder(const PictureCoding& picture, int directions) {
    Frame source = picture.source;
    for (int row = 0; row < source.rows(); ++row)
        for (int column = 0; column < source.columns(); ++column) {
            const Vector v = jump(column, row, source);
            Prediction prediction;
            const PredictionMode mode{{v, v}, {true, directions > 1}};
            predict_luma(picture, column, row, mode, prediction);
            predict_chroma(picture, column, row, mode, prediction);
            for (int plane = 0; plane < 3; ++plane) {
                const int size = plane == 0 ? 16 : 8;
                const std::uint8_t* from = plane == 0 ? prediction.y : plane == 1 ? prediction.cb : prediction.cr;
                for (int y = 0; y < size; ++y)
                    for (int x = 0; x < size; ++x) {
                        std::uint8_t& sample = source.plane(plane).at(column * size + x, row * size + y);
                        const int loud = (sample - 128) * (150 + 8 * column + row) / 1000;
                        sample = static_cast<std::uint8_t>(std::clamp(from[y * size + x] + loud, 0, 255));
                    }
            }
        }
    return source;
}

/// Largest macroblock of noise whose vectors jump, decided with f_code 4, as where some macroblock was offered a far
/// vector that it did not take, and written with f_code 1.
std::uint32_t largest_of_jumping_noise(PictureType type, Effort effort) {
    constexpr int columns = 30, rows = 20;
    const Frame any = noisy(columns, rows, 1), earlier = noisy(columns, rows, 2), later = noisy(columns, rows, 3);
    Frame reconstruction(columns, rows);
    const int directions = static_cast<int>(type) - 1;
    const Frame* const references[2] = {&earlier, directions > 1 ? &later : nullptr};
    Matrices flat;  // intra as fine as the rest, lest it be cheaper
    std::fill(flat.intra.begin() + 1, flat.intra.end(), std::uint8_t{16});
    const QuantiserSet quantisers(flat);
    const auto coding = [&](const Frame& source) {
        PictureCoding p{source, {references[0], references[1]}, reconstruction, type, {{4, 4}, {4, 4}}, 0.6f, effort};
        p.quantisers = &quantisers;
        return p;
    };
    const Frame source = predicted_and_louder(coding(any), directions);
    const PictureCoding picture = coding(source);
    std::uint32_t largest = 0;
    int inter = 0;
    for (int row = 1; row < rows - 1; ++row) {
        std::vector<BestVectors> choices(columns);
        for (int column = 0; column < columns; ++column)
            choices[static_cast<std::size_t>(column)].vector[0] = jump(column, row, source);
        const BestVectors* const vectors[2] = {choices.data(), choices.data()};
        const std::vector<std::uint8_t> finest(columns, 1);
        RowCode code = decide_row(picture, row, finest.data(), vectors);
        BitWriter out;
        SliceSyntax syntax{type, rows * 16, row, code.quantiser, {{1, 1}, {1, 1}}, false};
        write_slice(out, syntax, code);
        for (const MacroblockCode& m : code.macroblocks) {
            largest = std::max(largest, m.bits);
            inter += m.type.motion(directions - 1) ? 1 : 0;
        }
    }
    EXPECT_GT(inter, columns * (rows - 2) / 4);
    return largest;
}

TEST(MacroblockLimit, HoldsWithTheFCodesThatAreWritten) {
    for (const PictureType type : {PictureType::predicted, PictureType::bidirectional})
        for (const Effort effort : {Effort::fast, Effort::quality}) {
            const std::uint32_t largest = largest_of_jumping_noise(type, effort);
            EXPECT_LE(largest, macroblock_bits_limit) << static_cast<int>(type);
            EXPECT_GE(largest, macroblock_bits_limit - 250) << "the limit must be felt";
        }
}

/// Noise to be predicted from other noise.
PictureTask noise_task(const Frame& source, const Frame& reference) {
    return {source, PictureType::predicted, {&reference, nullptr}, {}, {}, source.rows() * 16, 1, 2, Effort::quality,
            {}};
}

TEST(Evaluations, OfAllTriesAreCounted) {
    const Frame source = noisy(5, 4, 1), reference = noisy(5, 4, 2);
    const Settings small = settings(80, 64);
    const Level& level = level_for(small);
    PictureTask task = noise_task(source, reference);
    task.quantiser = 20;
    const PictureResult first = code_picture(task, level);
    const Fitted second = code_within(task, level, 8 * static_cast<std::int64_t>(first.bytes.size()) - 8);
    ASSERT_EQ(second.tries, 2);
    PictureTask coarse = task;
    coarse.quantiser = second.quantiser;
    EXPECT_EQ(second.picture.evaluations, first.evaluations + code_picture(coarse, level).evaluations);
    const Fitted tight = code_within(task, level, 2000);
    EXPECT_GT(tight.tries, 2);
    EXPECT_GT(tight.picture.evaluations, second.picture.evaluations);
}

TEST(Evaluations, OfNoMacroblockExceedTheLimit) {
    // Whatever is offered: far and near candidates, predictors, both directions, and intra in question everywhere.
    for (const PictureType type : {PictureType::predicted, PictureType::bidirectional}) {
        const Frame source = noisy(1, 1, 1), reference = noisy(1, 1, 2), other = noisy(1, 1, 3);
        PictureTask task = noise_task(source, reference);
        task.type = type;
        if (type == PictureType::bidirectional) task.reference[1] = &other;
        EXPECT_LE(code_picture(task, level_for(settings(16, 16))).evaluations, 78u);
    }
    const Frame source = noisy(12, 12, 1), reference = noisy(12, 12, 2), other = noisy(12, 12, 3);
    struct Bounds {
        PictureType type;
        Effort effort;
        std::uint64_t least, most;  ///< per macroblock
    };
    for (const auto& [type, effort, least, most] : {Bounds{PictureType::predicted, Effort::quality, 20, 23},
                                                    {PictureType::bidirectional, Effort::quality, 64, 69},
                                                    {PictureType::predicted, Effort::fast, 13, 15},
                                                    {PictureType::bidirectional, Effort::fast, 26, 28}}) {
        PictureTask task = noise_task(source, reference);
        task.type = type;
        task.effort = effort;
        core::Plane<Candidates> offered(12, 12);
        for (int row = 0; row < 12; ++row)
            for (int column = 0; column < 12; ++column)
                for (int i = 0; i < Candidates::most; ++i)
                    offered.at(column, row)
                        .add(vector_range(column, row, 12, 12, 8, 5)
                                 .clamp((column * 37 + i * 61) % 90 - 45, (row * 53 + i * 29) % 90 - 45));
        task.exact[0] = &offered;
        if (type == PictureType::bidirectional) task.reference[1] = &other, task.exact[1] = &offered;
        const std::uint64_t evaluations = code_picture(task, level_for(settings(192, 192))).evaluations;
        EXPECT_LE(evaluations, most * 144) << static_cast<int>(type);
        EXPECT_GE(evaluations, least * 144) << static_cast<int>(type);
    }
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
