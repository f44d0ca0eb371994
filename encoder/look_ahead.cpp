#include "encoder/look_ahead.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/numeric.h"
#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/kernels/frame.h"
#include "encoder/mpeg2/kernels/kernels.h"
#include "encoder/mpeg2/motion/motion_compensation.h"
#include "encoder/mpeg2/motion/motion_search.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder {
namespace {

/// Half-size pixels to each side that are searched between neighbours, and about what those tell farther away.
constexpr int reach_of_neighbours = 24, reach_of_others = 8;

/// chosen: costs of a vector's bit in absolute differences (4 of 0 to 8): a smooth field.
constexpr float cost_per_bit = 4;

/// Weight of a B picture's Hadamard sum, over a P picture's: nothing refers to it.
/// chosen: 0.7 of 0.55 to 0.85: 0.55 needs 1.0 % more bits, 0.85 0.1 %.
constexpr double weight_of_b = 0.7;

/// A picture that shows nothing of the one before: prediction leaves at least this share of what it has by itself, and
/// so many times the share that it leaves of the picture's neighbour.
/// chosen: find the cuts of the fit set of bench/encoder_rd, and take no fade, shake or grain for one.
constexpr double cut_share = 0.75, cut_ratio = 1.5;

/// chosen: 8 code values per picture: a lamp that comes on changes its room by less (macroblock_tree.cpp).
constexpr double something_else = 8;

/// Luma in half the size, padded to whole blocks.
mpeg2::Frame half_size(const core::Picture& picture) {
    const int width = picture.y.width(), height = picture.y.height();
    const int columns = std::max(1, (width / 2 + 15) / 16), rows = std::max(1, (height / 2 + 15) / 16);
    mpeg2::Frame half(columns, rows);
    for (int y = 0; y < half.y.height(); ++y) {
        const std::uint8_t* upper = picture.y.row(std::min(2 * y, height - 1));
        const std::uint8_t* lower = picture.y.row(std::min(2 * y + 1, height - 1));
        std::uint8_t* out = half.y.row(y);
        for (int x = 0; x < half.y.width(); ++x) {
            const int left = std::min(2 * x, width - 1), right = std::min(2 * x + 1, width - 1);
            out[x] = static_cast<std::uint8_t>((upper[left] + upper[right] + lower[left] + lower[right] + 2) / 4);
        }
    }
    return half;
}

}  // namespace

struct LookAhead::Impl {
    int width, height, most_b;
    bool ended = false;

    /// A picture and its analysis.
    struct Seen {
        mpeg2::Frame half;
        core::Plane<float> alone;                                       ///< Hadamard sums of blocks by themselves
        std::map<std::int64_t, core::Plane<mpeg2::Vector>> vectors;     ///< to other pictures, half-size half pixels
        std::map<std::pair<std::int64_t, std::int64_t>, double> costs;  ///< by earlier and later reference
    };
    std::map<std::int64_t, Seen> seen;

    const core::Plane<mpeg2::Vector>& vectors(std::int64_t picture, std::int64_t reference);
    double cost(std::int64_t picture, std::int64_t earlier, std::int64_t later);
    double share_left(std::int64_t picture, std::int64_t reference);
    core::Plane<std::optional<double>> light_change(std::int64_t picture, std::int64_t reference);
    bool is_lit(std::int64_t picture, std::int64_t reference);
    bool is_there(std::int64_t number) const { return seen.find(number) != seen.end(); }

    /// Sum of a function of each block.
    template <class F>
    static double sum(int columns, int rows, F of) {
        std::vector<double> parts(static_cast<std::size_t>(rows), 0.0);
        parallel::for_each(parts.size(), [&](std::size_t row) {
            for (int column = 0; column < columns; ++column) parts[row] += of(column, static_cast<int>(row));
        });
        double all = 0;
        for (const double part : parts) all += part;
        return all;
    }
};

/// Vectors between two pictures: searched about those that lead as far in steps, and in the picture next to it.
const core::Plane<mpeg2::Vector>& LookAhead::Impl::vectors(std::int64_t picture, std::int64_t reference) {
    Seen& from = seen.at(picture);
    const auto known = from.vectors.find(reference);
    if (known != from.vectors.end()) return known->second;
    const std::int64_t step = reference > picture ? 1 : -1;
    const bool neighbours = reference == picture + step;
    const mpeg2::Frame &here = from.half, &there = seen.at(reference).half;
    core::Plane<mpeg2::Vector> guess(here.columns(), here.rows());
    if (!neighbours) {
        guess = vectors(picture, reference - step);
        const auto distance = static_cast<int>(std::abs(reference - picture));
        for (mpeg2::Vector& v : guess.values())
            v = {static_cast<std::int16_t>(v.x * distance / (distance - 1)),
                 static_cast<std::int16_t>(v.y * distance / (distance - 1))};
    }
    core::Plane<mpeg2::Vector> found(here.columns(), here.rows());
    parallel::for_each(static_cast<std::size_t>(here.rows()), [&](std::size_t r) {
        const int row = static_cast<int>(r);
        mpeg2::Vector left;
        for (int column = 0; column < here.columns(); ++column) {
            const mpeg2::VectorRange allowed =
                mpeg2::vector_range(column, row, here.columns(), here.rows(), 8, mpeg2::vertical_f_code_limit);
            core::Smallest<mpeg2::Vector, 1> best;
            const auto search = [&](mpeg2::Vector centre) {
                const int reach = neighbours ? reach_of_neighbours : reach_of_others;
                const mpeg2::SearchResult result = mpeg2::search_whole_pixels(
                    here, there, {column, row, allowed, allowed.clamp(centre), reach, left, cost_per_bit});
                if (result.vectors.size() > 0) best.add(result.vectors[0], result.vectors.key(0));
            };
            search(guess.at(column, row));
            if (!guess.at(column, row).is_zero()) search({});  // a flash may lie between
            left = best.size() > 0 ? best[0] : mpeg2::Vector{};
            found.at(column, row) = left;
        }
    });
    return from.vectors.emplace(reference, std::move(found)).first->second;
}

/// Residual of a picture: sum over blocks of the least of intra, each reference alone and their mean. A P picture has
/// no later reference: `later` is its number.
double LookAhead::Impl::cost(std::int64_t picture, std::int64_t earlier, std::int64_t later) {
    auto& known = seen.at(picture).costs;
    const auto found = known.find({earlier, later});
    if (found != known.end()) return found->second;
    const core::Plane<mpeg2::Vector>& forward = vectors(picture, earlier);
    const core::Plane<mpeg2::Vector>* backward = later != picture ? &vectors(picture, later) : nullptr;
    const Seen& s = seen.at(picture);
    const mpeg2::Frame &before = seen.at(earlier).half, &after = seen.at(later).half;
    const double cost = sum(s.half.columns(), s.half.rows(), [&](int column, int row) {
        float least = std::min(s.alone.at(column, row),
                               static_cast<float>(mpeg2::satd(s.half, before, column, row, forward.at(column, row))));
        if (backward) {
            const mpeg2::Vector both[2] = {forward.at(column, row), backward->at(column, row)};
            alignas(32) std::uint8_t samples[256];
            least = std::min(least, static_cast<float>(mpeg2::satd(s.half, after, column, row, both[1])));
            least = std::min(
                least, static_cast<float>(mpeg2::satd_of_mean(s.half, before, after, column, row, both, samples)));
        }
        return least;
    });
    known.emplace(std::pair(earlier, later), cost);
    return cost;
}

/// Residual of a picture over its intra cost, 0..1; 1 where that cost is 0.
double LookAhead::Impl::share_left(std::int64_t picture, std::int64_t reference) {
    const Seen& s = seen.at(picture);
    const double alone =
        sum(s.half.columns(), s.half.rows(), [&](int column, int row) { return s.alone.at(column, row); });
    return core::divide_or(cost(picture, reference, picture), alone, 1.0);
}

/// Whether light changes between two pictures: blocks do along motion, and like their neighbours. Noise, resampled
/// detail and vectors that miss change each block by itself.
bool LookAhead::Impl::is_lit(std::int64_t picture, std::int64_t reference) {
    const mpeg2::Frame& here = seen.at(picture).half;
    const core::Plane<std::optional<double>> changes = light_change(picture, reference);
    double together = 0, apart = 0;
    int blocks = 0;
    for (int row = 0; row < here.rows(); ++row)
        for (int column = 0; column < here.columns(); ++column) {
            double sum = 0;
            int count = 0;
            for (int r = std::max(0, row - 1); r < std::min(here.rows(), row + 2); ++r)
                for (int c = std::max(0, column - 1); c < std::min(here.columns(), column + 2); ++c) {
                    sum += changes.at(c, r).value_or(0);
                    count += changes.at(c, r) ? 1 : 0;
                }
            if (!changes.at(column, row)) continue;
            together += std::abs(sum / count);
            apart += std::abs(*changes.at(column, row) - sum / count);
            ++blocks;
        }
    return together > apart && together > mpeg2::steady_light * blocks;
}

/// Code values per picture by which each block's mean changes along motion; none where it shows something else.
core::Plane<std::optional<double>> LookAhead::Impl::light_change(std::int64_t picture, std::int64_t reference) {
    const core::Plane<mpeg2::Vector>& moved = vectors(picture, reference);
    const mpeg2::Frame &here = seen.at(picture).half, &there = seen.at(reference).half;
    const auto pictures = static_cast<double>(std::abs(picture - reference));
    core::Plane<std::optional<double>> changes(here.columns(), here.rows());
    for (int row = 0; row < here.rows(); ++row)
        for (int column = 0; column < here.columns(); ++column) {
            const mpeg2::Vector v = moved.at(column, row);  // of whole pixels
            int difference = 0;
            for (int y = 16 * row; y < 16 * row + 16; ++y) {
                const std::uint8_t* now = here.y.row(y) + 16 * column;
                const std::uint8_t* then = there.y.row(y + v.y / 2) + 16 * column + v.x / 2;
                for (int x = 0; x < 16; ++x) difference += now[x] - then[x];
            }
            const double change = difference / (256 * pictures);
            if (std::abs(change) <= something_else) changes.at(column, row) = change;
        }
    return changes;
}

LookAhead::LookAhead(int width, int height, int b_pictures)
    : impl_(std::make_unique<Impl>(Impl{width, height, b_pictures, false, {}})) {
    EXPECTS(width > 0 && height > 0 && b_pictures >= 0 && b_pictures <= 3);
}
LookAhead::~LookAhead() = default;

void LookAhead::add(const core::Picture& picture) {
    Impl& m = *impl_;
    EXPECTS(picture.width() == m.width && picture.height() == m.height);
    EXPECTS(m.seen.empty() || m.seen.rbegin()->first + 1 == picture.number);
    Impl::Seen s;
    s.half = half_size(picture);
    s.alone = core::Plane<float>(s.half.columns(), s.half.rows());
    for (int row = 0; row < s.half.rows(); ++row)
        for (int column = 0; column < s.half.columns(); ++column)
            s.alone.at(column, row) = static_cast<float>(
                mpeg2::kernels().activity_16x16(s.half.y.row(16 * row) + 16 * column, s.half.y.width()));
    m.seen.emplace(picture.number, std::move(s));
}

void LookAhead::forget_before(std::int64_t number) {
    auto& seen = impl_->seen;
    seen.erase(seen.begin(), seen.lower_bound(number));
}

bool LookAhead::cut_before(std::int64_t number) {
    Impl& m = *impl_;
    if (!m.is_there(number - 1)) return false;
    const double here = m.share_left(number, number - 1);
    if (here < cut_share) return false;
    // Grain, fades and fast motion leave as much in other pictures.
    const std::int64_t other = m.is_there(number - 2) ? number - 1 : number + 1;
    if (m.is_there(other) && here < cut_ratio * m.share_left(other, other - 1)) return false;
    // After a flash all is as before.
    const std::int64_t next = number + 1;
    if (m.is_there(next) && m.share_left(next, number - 1) < cut_share) return false;
    return true;
}

void LookAhead::end() {
    impl_->ended = true;
}

std::optional<std::int64_t> LookAhead::frames_left(std::int64_t number) {
    Impl& m = *impl_;
    EXPECTS(m.is_there(number));
    // The newest picture may yet turn out to be a flash.
    const std::int64_t newest = m.seen.rbegin()->first, known = m.ended ? newest : std::max(number, newest - 1);
    std::int64_t last = number;
    while (last < known && !cut_before(last + 1)) ++last;
    if (last == known && !m.ended) return {};
    return last - number;
}

bool LookAhead::light_changes(std::int64_t reference, std::int64_t last) {
    Impl& m = *impl_;
    std::int64_t far = std::min(last, reference + m.most_b + 1);
    while (!m.is_there(far)) --far;
    return far > reference + 1 && m.is_lit(far, reference);
}

int LookAhead::b_pictures(std::int64_t reference, std::int64_t last) {
    Impl& m = *impl_;
    last = std::min(last, reference + depth - 1);
    while (!m.is_there(last)) --last;
    const std::int64_t count = last - reference;
    // Costs do not tell of light, since a block's mean takes as few bits over two pictures as over one.
    if (light_changes(reference, last)) return std::min(1, m.most_b);
    // The least cost of the pictures up to each P picture, and the first run's length there.
    std::array<double, depth + 1> least{};
    std::array<int, depth + 1> first{};
    for (std::int64_t end = 1; end <= count; ++end) {
        double& best = least[static_cast<std::size_t>(end)];
        best = std::numeric_limits<double>::infinity();
        for (int b = 0; b <= std::min<std::int64_t>(m.most_b, end - 1); ++b) {
            const std::int64_t from = reference + end - 1 - b, to = reference + end;
            double cost = least[static_cast<std::size_t>(end - 1 - b)] + m.cost(to, from, to);
            for (std::int64_t n = from + 1; n < to; ++n) cost += weight_of_b * m.cost(n, from, to);
            if (cost >= best) continue;
            best = cost;
            first[static_cast<std::size_t>(end)] = end - 1 - b > 0 ? first[static_cast<std::size_t>(end - 1 - b)] : b;
        }
    }
    return first[static_cast<std::size_t>(std::max<std::int64_t>(0, count))];
}

core::MotionField LookAhead::motion(std::int64_t picture, std::int64_t reference) {
    Impl& m = *impl_;
    const core::Plane<mpeg2::Vector>& vectors = m.vectors(picture, reference);
    core::MotionField field;
    field.picture = picture;
    field.reference = reference;
    field.vector = core::Plane<glm::vec2>(m.width, m.height);
    field.kind = core::Plane<core::PixelClass>(m.width, m.height, core::PixelClass::surface);
    for (int y = 0; y < m.height; ++y)
        for (int x = 0; x < m.width; ++x) {
            const mpeg2::Vector v =
                vectors.at(std::min(x / 32, vectors.width() - 1), std::min(y / 32, vectors.height() - 1));
            field.vector.at(x, y) = {v.x, v.y};  // half of half pixels
        }
    return field;
}

}  // namespace render2mpeg::encoder
