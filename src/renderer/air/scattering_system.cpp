#include "renderer/air/scattering_system.h"

#include <algorithm>
#include <deque>
#include <numeric>

#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Dense media that absorb nothing amplify residuals by the number of scatterings, some thousands.
constexpr double enough = 1e-7;
constexpr int most_turns = 200;
/// Directions that new ones are made orthogonal to.
constexpr std::size_t kept = 8;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void add(double factor, const std::vector<double>& from, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

}  // namespace

void ScatteringSystem::Sums::move_to(Row& row, float part) {
    row.cells.reserve(touched_.size());
    row.weights.reserve(touched_.size());
    for (const std::uint32_t c : touched_) {
        row.cells.push_back(c);
        row.weights.push_back(part * weights_[c]);
        weights_[c] = 0;
    }
    touched_.clear();
}

/// (x - K (albedo x)) / own_share
ScatteringSystem::Values ScatteringSystem::remaining(const Values& x, const Values& albedo,
                                                     const Values& own_share) const {
    Values scattered(x.size()), result(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) scattered[i] = albedo[i] * x[i];
    parallel::for_ranges(x.size(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Row& row = rows_[i];
            double sum = 0;
            for (std::size_t k = 0; k < row.cells.size(); ++k)
                sum += static_cast<double>(row.weights[k]) * scattered[row.cells[k]];
            result[i] = (x[i] - sum) / own_share[i];
        }
    });
    return result;
}

ScatteringSystem::Values ScatteringSystem::solve(const Values& own, const Values& albedo) const {
    struct Direction {
        Values step, change;
        double square;
    };
    Values own_share(own.size(), 1.0), x = own;
    for (std::size_t i = 0; i < own.size(); ++i) {
        for (std::size_t k = 0; k < rows_[i].cells.size(); ++k)
            if (rows_[i].cells[k] == i) own_share[i] -= albedo[i] * static_cast<double>(rows_[i].weights[k]);
        own_share[i] = std::max(own_share[i], 1e-6);
        x[i] /= own_share[i];
    }
    const double wanted = enough * enough * dot(x, x);
    Values residual = remaining(x, albedo, own_share);
    for (std::size_t i = 0; i < x.size(); ++i) residual[i] = own[i] / own_share[i] - residual[i];
    std::deque<Direction> directions;
    for (int turn = 0; turn < most_turns && dot(residual, residual) > wanted; ++turn) {
        Direction d{residual, remaining(residual, albedo, own_share), 0};
        for (const Direction& before : directions) {
            const double share = core::divide_or(dot(d.change, before.change), before.square, 0.0);
            add(-share, before.step, d.step);
            add(-share, before.change, d.change);
        }
        d.square = dot(d.change, d.change);
        const double length = core::divide_or(dot(residual, d.change), d.square, 0.0);
        if (length == 0.0) break;
        add(length, d.step, x);
        add(-length, d.change, residual);
        directions.push_back(std::move(d));
        if (directions.size() > kept) directions.pop_front();
    }
    for (double& value : x) value = std::max(value, 0.0);
    return x;
}

std::vector<glm::vec3> ScatteringSystem::solve(const std::vector<glm::vec3>& own,
                                               const std::vector<glm::vec3>& albedo) const {
    std::vector<glm::vec3> result(own.size());
    Values b(own.size()), a(own.size());
    for (int c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < own.size(); ++i) {
            b[i] = static_cast<double>(own[i][c]);
            a[i] = static_cast<double>(albedo[i][c]);
        }
        const Values x = solve(b, a);
        for (std::size_t i = 0; i < own.size(); ++i) result[i][c] = static_cast<float>(x[i]);
    }
    return result;
}

}  // namespace render2mpeg::renderer
