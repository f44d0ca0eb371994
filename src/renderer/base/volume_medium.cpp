#include "renderer/base/volume_medium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/base/blackbody.h"

namespace render2mpeg::renderer {
namespace {

constexpr float endless = std::numeric_limits<float>::infinity();

/// A step is a voxel long, two where no more than this optical depth of a brick is uneven, a half where more than the
/// second is; of secondary rays twice as long. At most `depth_of_step` lies in one step, down to an eighth of a voxel.
/// chosen: not tuned.
constexpr float uneven_depth = 0.02f, most_uneven_depth = 0.16f, depth_of_step = 0.5f, least_step = 0.125f;

/// Largest extinction and emission, by unit of way, that sums along rays stay finite with.
constexpr float most_extinction = 1e20f, most_emission = 1e15f;

}  // namespace

VolumeField::VolumeField(const scene::Volume& volume, std::shared_ptr<const scene::VolumeGrids> grids)
    : volume_(volume), grids_(std::move(grids)) {
    volume_.grids = nullptr;
    volume_.files.clear();
    volume_.more_files.clear();
    const auto hold = [&](glm::ivec3 low, glm::ivec3 size) {
        const glm::ivec3 end = glm::max(low_ + size_, low + size);
        low_ = size_ == glm::ivec3(0) ? low - 1 : glm::min(low_, low - 1);
        size_ = end - low_;
    };
    const bool hot = volume_.blackbody_intensity > 0.0f && !grids_->temperature.empty();
    if (!grids_->density.empty()) hold(grids_->density.low(), grids_->density.size());
    if (hot) hold(grids_->temperature.low(), grids_->temperature.size());
    ranges_.resize(std::size_t(size_.x) * std::size_t(size_.y) * std::size_t(size_.z));
    std::size_t next = 0;
    for (int z = 0; z < size_.z; ++z)
        for (int y = 0; y < size_.y; ++y)
            for (int x = 0; x < size_.x; ++x) {
                Range& range = ranges_[next++];
                const glm::ivec3 brick = low_ + glm::ivec3(x, y, z);
                const auto there = [&](const core::SparseGrid<float>& grid) {
                    for (int c = 0; c < 8; ++c)
                        if (grid.find(brick + glm::ivec3(c & 1, c >> 1 & 1, c >> 2)) != nullptr) return true;
                    return false;
                };
                const bool dense = there(grids_->density), warm = hot && there(grids_->temperature);
                if (!dense && !warm) continue;
                range.least = endless;
                for (int k = 0; k < 9; ++k)
                    for (int j = 0; j < 9; ++j)
                        for (int i = 0; i < 9; ++i) {
                            const glm::ivec3 voxel = 8 * brick + glm::ivec3(i, j, k);
                            const float density = grids_->density.at(voxel);
                            range.least = std::min(range.least, density);
                            range.most = std::max(range.most, density);
                            most_ = std::max(most_, density);
                            range.any = range.any || density > 0.0f || (warm && grids_->temperature.at(voxel) > 0.0f);
                        }
            }
    find_flames();
}

const VolumeField::Range& VolumeField::range(glm::ivec3 brick) const {
    static const Range none;
    const glm::ivec3 at = brick - low_;
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= size_.x || at.y >= size_.y || at.z >= size_.z) return none;
    return ranges_[std::size_t(at.x) +
                   std::size_t(size_.x) * (std::size_t(at.y) + std::size_t(size_.y) * std::size_t(at.z))];
}

bool VolumeField::holds(glm::ivec3 voxel) const {
    return grids_->density.at(voxel) > 0.0f ||
           (volume_.blackbody_intensity > 0.0f && grids_->temperature.at(voxel) > 0.0f);
}

float VolumeField::density(glm::vec3 place) const {
    return interpolated(grids_->density, place);
}

glm::vec3 VolumeField::emission_of(float density, float temperature) const {
    glm::vec3 sum = volume_.emission_strength * density * volume_.emission_color;
    if (volume_.blackbody_intensity > 0.0f)
        sum +=
            volume_.blackbody_tint * blackbody_radiance(volume_.temperature * temperature, volume_.blackbody_intensity);
    return glm::min(sum, most_emission);
}

glm::vec3 VolumeField::emission(glm::vec3 place) const {
    if (!shines_) return glm::vec3(0);
    const bool hot = volume_.blackbody_intensity > 0.0f;
    return emission_of(volume_.emission_strength > 0.0f ? density(place) : 0.0f,
                       hot ? interpolated(grids_->temperature, place) : 0.0f);
}

/// Halves what shines along its longest side, again and again, with as much light on either side.
void VolumeField::find_flames() {
    if (!volume_.emits()) return;
    struct Voxel {
        glm::vec3 place, light;
        float weight;
    };
    std::vector<Voxel> voxels;
    each_brick([&](glm::ivec3 brick) {
        for (int k = 0; k < core::SparseGrid<float>::brick_voxels; ++k) {
            const glm::ivec3 v = core::SparseGrid<float>::voxel(brick, k);
            const glm::vec3 light = emission_of(grids_->density.at(v), grids_->temperature.at(v));
            if (const float weight = core::luminance(light); weight > 0.0f)
                voxels.push_back({glm::vec3(v), light, weight});
        }
    });
    shines_ = !voxels.empty();
    const auto split = [&](const auto& self, std::size_t first, std::size_t last, std::size_t parts) -> void {
        if (first == last) return;
        glm::vec3 low(endless), high(-endless);
        for (std::size_t i = first; i < last; ++i) {
            low = glm::min(low, voxels[i].place);
            high = glm::max(high, voxels[i].place);
        }
        if (parts > 1 && last - first > 1) {
            const glm::vec3 side = high - low;
            const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
            std::stable_sort(voxels.begin() + std::ptrdiff_t(first), voxels.begin() + std::ptrdiff_t(last),
                             [&](const Voxel& a, const Voxel& b) { return a.place[axis] < b.place[axis]; });
            double all = 0, sum = 0;
            for (std::size_t i = first; i < last; ++i) all += voxels[i].weight;
            std::size_t middle = first;
            while (middle + 1 < last && 2 * (sum += voxels[middle].weight) < all) ++middle;
            middle = std::clamp(middle, first + 1, last - 1);
            self(self, first, middle, parts / 2);
            return self(self, middle, last, parts / 2);
        }
        Flame flame;
        glm::dvec3 place(0), light(0);
        double weight = 0, squares = 0;
        for (std::size_t i = first; i < last; ++i) {
            weight += voxels[i].weight;
            place += double(voxels[i].weight) * glm::dvec3(voxels[i].place);
            light += glm::dvec3(voxels[i].light);
        }
        flame.place = glm::vec3(place / weight);
        for (std::size_t i = first; i < last; ++i) {
            const glm::vec3 off = voxels[i].place - flame.place;
            squares += double(voxels[i].weight * (glm::dot(off, off) + 0.25f));
        }
        flame.radius = float(std::sqrt(squares / weight));
        flame.intensity = glm::vec3(light);
        flames_.push_back(flame);
    };
    split(split, 0, voxels.size(), most_flames);
}

VolumeMedium::VolumeMedium(const scene::Volume& volume, std::shared_ptr<const VolumeField> field,
                           const glm::dmat4& world_from_object)
    : field_(std::move(field)), anisotropy_(volume.anisotropy) {
    const glm::dmat4 to_world = world_from_object * field_->grids().object_from_index;
    const double cube = std::abs(glm::determinant(glm::dmat3(to_world)));
    // As Cycles has it for volumes in object space.
    const double stretch = glm::length(glm::dmat3(world_from_object) * glm::dvec3(1 / std::sqrt(3.0)));
    world_from_index_ = glm::mat4(to_world);
    if (!(cube > 0) || !std::isfinite(cube) || !(stretch > 0)) return;
    index_from_world_ = glm::mat4(glm::inverse(to_world));
    if (!core::is_finite(index_from_world_) || !core::is_finite(world_from_index_)) return;
    voxel_ = float(std::cbrt(cube));
    scale_ = float(1 / stretch);
    color_ = volume.color;
    unabsorbed_ = 1.0f - glm::sqrt(glm::clamp(volume.absorption_color, glm::vec3(0), glm::vec3(1)));
    density_ = std::min(volume.density * scale_, most_extinction / std::max(field_->most(), 1.0f));
    const glm::vec3 most = field_->grids().color.empty() ? color_ + (1.0f - color_) * unabsorbed_ : glm::vec3(1);
    largest_ = density_ * std::max({most.x, most.y, most.z});
}

glm::vec3 VolumeMedium::color_at(glm::vec3 place) const {
    const core::SparseGrid<glm::vec3>& grid = field_->grids().color;
    return grid.empty() ? color_ : color_ * interpolated(grid, place);
}

MediumPoint VolumeMedium::at(glm::vec3 place) const {
    MediumPoint point;
    const float density = density_ * field_->density(place);
    const glm::vec3 color = color_at(place);
    point.scattering = density * color;
    point.extinction = density * (color + (1.0f - color) * unabsorbed_);
    if (field_->shines()) point.emission = scale_ * field_->emission(place);
    return point;
}

glm::vec3 VolumeMedium::extinction(glm::vec3 place) const {
    const glm::vec3 color = color_at(place);
    return density_ * field_->density(place) * (color + (1.0f - color) * unabsorbed_);
}

glm::vec3 VolumeMedium::albedo(glm::vec3 place) const {
    const glm::vec3 color = color_at(place), all = color + (1.0f - color) * unabsorbed_;
    return {core::divide_or(color.x, all.x, 0.0f), core::divide_or(color.y, all.y, 0.0f),
            core::divide_or(color.z, all.z, 0.0f)};
}

BrickWalk::BrickWalk(const VolumeMedium& medium, glm::vec3 origin, glm::vec3 direction)
    : medium_(&medium), origin_(medium.to_index(origin)), direction_(medium.vector_to_index(direction)) {
    const VolumeField& field = medium.field();
    float near = 0, far = endless;
    for (int c = 0; c < 3; ++c) {
        const float low = 8.0f * float(field.low()[c]), high = 8.0f * float(field.low()[c] + field.size()[c]);
        if (direction_[c] == 0.0f) {
            if (origin_[c] < low || origin_[c] >= high) return;
            continue;
        }
        const float a = (low - origin_[c]) / direction_[c], b = (high - origin_[c]) / direction_[c];
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    meets_ = !medium.empty() && far > near && std::isfinite(far);
    voxels_ = glm::length(direction_);
    in_ = near;
    out_ = far;
    end_ = near;
}

void BrickWalk::advance() {
    const VolumeField& field = medium_->field();
    if (!began_) {
        began_ = true;
        const glm::vec3 at = place(in_) / 8.0f;
        for (int c = 0; c < 3; ++c) {
            brick_[c] = std::clamp(int(std::floor(at[c])), field.low()[c], field.low()[c] + field.size()[c] - 1);
            turn_[c] = direction_[c] > 0.0f ? 1 : -1;
        }
    } else if (end_ >= out_) {
        inside_ = nullptr;
        end_ = endless;
        return;
    } else {
        const int axis = next_.x <= next_.y && next_.x <= next_.z ? 0 : next_.y <= next_.z ? 1 : 2;
        brick_[axis] += turn_[axis];
        // From far away the last pieces are shorter than their distance can tell.
        if (brick_[axis] < field.low()[axis] || brick_[axis] >= field.low()[axis] + field.size()[axis]) {
            inside_ = nullptr;
            end_ = out_;
            return;
        }
    }
    for (int c = 0; c < 3; ++c)
        next_[c] = direction_[c] == 0.0f
                       ? endless
                       : (8.0f * float(brick_[c] + (turn_[c] > 0 ? 1 : 0)) - origin_[c]) / direction_[c];
    inside_ = &field.range(brick_);
    end_ = std::min(std::max(end_, std::min({next_.x, next_.y, next_.z})), out_);
}

float BrickWalk::step(bool coarse) const {
    const float voxel = 1.0f / voxels_;
    const float most = medium_->largest_extinction(*inside_);
    const float uneven = most * (1.0f - core::divide_or(inside_->least, inside_->most, 0.0f)) * 8.0f * voxel;
    const float even = uneven < uneven_depth ? 2.0f : uneven < most_uneven_depth ? 1.0f : 0.5f;
    const float step = coarse ? 2.0f * even : medium_->field().shines() ? std::min(even, 1.0f) : even;
    return voxel * std::max(std::min(step, core::divide_or(depth_of_step, most * voxel, step)), least_step);
}

}  // namespace render2mpeg::renderer
