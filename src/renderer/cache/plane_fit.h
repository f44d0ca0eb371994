#pragma once
// Fits a plane through neighbouring records' light.
#include <array>
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// A plane of least weighted squares through colours at places of the picture, about the place (0, 0).
class PlaneFit {
  public:
    /// Samples that it may rest on. Where more lie within a radius and the nearer ones disagree, more will not help.
    static constexpr int most = 40;
    /// It takes three; the rest say how well it fits. chosen: 6 of 4 and 6: at 4 twice as many pixels err by more than
    /// they may.
    static constexpr int least = 6;

    void clear() { count_ = 0; }
    bool is_full() const { return count_ == most; }
    /// `offset` in pixels, `closeness` > 0 its weight.
    void add(glm::vec2 offset, float closeness, glm::vec3 value) {
        samples_[static_cast<std::size_t>(count_++)] = {offset, closeness, value};
    }
    int count() const { return count_; }
    float closeness(int i) const { return samples_[static_cast<std::size_t>(i)].closeness; }

    /// Whether there are samples enough, on several sides, and the place hardly lies beyond them.
    bool fit();

    /// The weighted mean of three or more as a level plane, for what changes little from place to place.
    bool fit_mean();

    /// How far the place lies from the middle of the samples, over how far they lie from it (root of the mean square).
    float reach() const;

    /// At the place: the sum of all values by these weights.
    glm::vec3 value() const { return plane_[0]; }
    float weight(int i) const { return weights_[static_cast<std::size_t>(i)]; }

    /// Residual of samples about the plane, as it is noticed: root of the mean square, degrees of freedom counted.
    float residual() const;
    /// Rise of the plane's luminance up to the nearest sample.
    float rise() const;
    /// Largest such rise along rows, columns or the plane's own gradient, of the directions in which samples lie in two
    /// columns: through two a plane always passes, and a step between them looks like a slope.
    float unsure_rise() const;
    /// Index of that.
    int nearest() const;
    float distance(int i) const;

  private:
    bool in_two_columns(glm::vec2 along) const;

    struct Sample {
        glm::vec2 offset;
        float closeness;
        glm::vec3 value;
    };
    // The first `count_`; none is cleared, since planes are made by the million.
    std::array<Sample, most> samples_;
    std::array<float, most> weights_;
    glm::vec3 plane_[3]{};  ///< at the place, and its slopes
    int count_ = 0;
    int freedoms_ = 3;  ///< that went into the plane
};

}  // namespace render2mpeg::renderer
