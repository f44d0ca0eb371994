#pragma once
// Textures with mip pyramids, filtered anisotropically.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/plane.h"
#include "core/wrap.h"
#include "image/image.h"
#include "image/stored_image.h"

namespace render2mpeg::image {

/// The next level of a mip pyramid: each side is halved (rounded down, at least 1), whatever its length, by a filter
/// that spans the exact ratio of the two lengths, so that nothing shifts and, where the image repeats, the mean stays.
/// Values are linear.
core::Plane<glm::vec4> halve(const core::Plane<glm::vec4>& level, core::Wrap wrap_u, core::Wrap wrap_v);

/// Hands out row `y` of a level, which stays until the next call.
using RowOf = std::function<const glm::vec4*(int y)>;

/// The same for a level of `width` x `height` that need not be in memory: each row is asked for once but for those that
/// an edge wants again.
core::Plane<glm::vec4> halve(int width, int height, const RowOf& row, core::Wrap wrap_u, core::Wrap wrap_v);

/// The texel that stands for `i` of a row of `n`.
int wrapped(int i, int n, core::Wrap wrap);

/// The area of texture that a pixel sees, as the two edges of a parallelogram in texture coordinates. Zero: a point.
struct Footprint {
    glm::vec2 dx{0, 0};
    glm::vec2 dy{0, 0};
};

enum class Encoding { linear, srgb };

/// Meaning of the fourth channel: one more number (glossiness), or the texel's coverage. Under `coverage` colours are
/// averaged in proportion to it, so that the black around a cut-out leaf does not darken its edge.
enum class AlphaMeaning { value, coverage };

/// An image with its mip pyramid, filtered anisotropically (docs/model/images.md). Values come linear and
/// unassociated; alpha is never sRGB. Any finite or non-finite coordinate gives a finite value. What is stored in 8
/// bits per channel is kept so, other images as floats; NaN counts as 0, infinity as the largest half float; magnitudes
/// end at 1e18.
class Texture {
  public:
    /// White, without an image.
    Texture() = default;
    /// `nearest`: texels keep their edges when magnified. The image must have pixels.
    Texture(const StoredImage& image, Encoding encoding, core::Wrap wrap_u, core::Wrap wrap_v, bool nearest = false,
            AlphaMeaning alpha = AlphaMeaning::value);

    /// Mean over the footprint about uv; uv (0, 0) is the upper left corner of the image. Where the coordinates or the
    /// footprint are not finite: mean().
    glm::vec4 sample(glm::vec2 uv, const Footprint& footprint) const;

    /// One bilinear probe of the level whose texels are nearest to `texels` wide, in texels of the finest: for rays of
    /// which many share the work.
    glm::vec4 probe(glm::vec2 uv, float texels) const;

    /// Mean of the whole texture.
    glm::vec4 mean() const { return mean_; }
    int width() const { return levels_.empty() ? 0 : levels_.front().width; }
    int height() const { return levels_.empty() ? 0 : levels_.front().height; }
    core::Wrap wrap_u() const { return wrap_u_; }
    core::Wrap wrap_v() const { return wrap_v_; }
    /// A channel of a texel of the finest level, as samples without a footprint mix it: in codes the fourth, or any of
    /// a linear image whose alpha is no coverage.
    float texel(int x, int y, int channel) const;
    /// Of all levels.
    std::size_t bytes() const { return codes_.size() + floats_.size() * sizeof(glm::vec4); }

  private:
    struct Level {
        int width = 0, height = 0;
        float texel = 1;        ///< size of one texel here in texels of level 0, the longer side
        std::size_t first = 0;  ///< where its texels begin
    };
    struct Probes;

    void begin_level(int columns, int rows);
    void append_linear(std::span<const glm::vec4> linear, bool in_codes);
    glm::vec4 unassociated(glm::vec4 v) const;
    Probes cover(glm::vec2 uv, const Footprint& footprint) const;
    template <class Texels>
    glm::vec4 filter(const Texels& texels, const Probes& probes) const;
    glm::vec4 filter(const Probes& probes) const;

    std::vector<Level> levels_;
    std::vector<std::uint8_t> codes_;  ///< RGBA of all levels, in the encoding; empty where floats are kept
    std::vector<glm::vec4> floats_;    ///< linear; empty where codes are kept
    glm::vec4 mean_{1, 1, 1, 1};
    core::Wrap wrap_u_ = core::Wrap::repeat, wrap_v_ = core::Wrap::repeat;
    Encoding encoding_ = Encoding::linear;
    AlphaMeaning alpha_ = AlphaMeaning::value;
    bool nearest_ = false;
};

}  // namespace render2mpeg::image
