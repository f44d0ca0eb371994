#pragma once
// Searches the quality setting that meets a target, with few tries.
#include <optional>
#include <vector>

namespace render2mpeg::app {

/// Searches the quality (--quality, 0..100) at which a figure that rises with it, of pictures coded with it, meets a
/// target, with few probes: a monotone cubic through what is known, turned around, as target-quality tools do
/// [Fritsch1980]. Since quantisers are whole numbers the figure rises in steps: between two of them the target may lie.
class QualitySearch {
  public:
    struct Known {
        double quality = 0, figure = 0;
    };

    /// `slope`: by how much the figure rises for each unit of quality, about, while one point only is known; > 0.
    QualitySearch(double target, double slope) : target_(target), slope_(slope) {}

    /// What a probe found; of the same quality the last counts. Figures are finite.
    void add(double quality, double figure);

    /// Where to probe next, a multiple of `step` that was not probed; none where nothing is known, where the target
    /// lies between neighbours, or beyond what 0 and 100 give.
    std::optional<double> next() const;

    /// Of what is known, that nearest to the target; only after add().
    const Known& nearest() const;
    /// The coarsest whose figure is the target's or more; none where there is none.
    std::optional<Known> coarsest_above() const;
    /// The finest whose figure is the target's or less; none where there is none.
    std::optional<Known> finest_below() const;
    const std::vector<Known>& known() const { return known_; }

    /// chosen: a change of quantisers by 0.35 % rounds few pictures' otherwise, and two decimals are few enough to be
    /// typed (0.02..0.5).
    static constexpr double step = 0.1;

  private:
    double target_, slope_;
    std::vector<Known> known_;  ///< by quality
};

}  // namespace render2mpeg::app
