#pragma once
// Searches the quality setting that meets a target.
#include <optional>
#include <vector>

namespace render2mpeg::app {

/// Searches the --quality (0..100) at which a rising figure meets a target: by false position, and by halves in the
/// end. The figure rises in steps, since quantisers are integers.
class QualitySearch {
  public:
    struct Known {
        double quality = 0, figure = 0;
    };

    explicit QualitySearch(double target) : target_(target) {}

    /// Result of a probe of another quality; figures are finite.
    void add(double quality, double figure);

    /// Next probe, a multiple of `step`; none where nothing is known, the target lies between neighbours, or beyond 0
    /// and 100.
    std::optional<double> next() const;

    /// Nearest to the target; after add() only.
    const Known& nearest() const;
    /// Coarsest with at least the target.
    std::optional<Known> coarsest_above() const;
    /// Finest with at most the target.
    std::optional<Known> finest_below() const;
    const std::vector<Known>& known() const { return known_; }

    /// chosen: a change of quantisers by 0.35 % rounds few pictures' otherwise, and one decimal is few enough to be
    /// typed (0.02..0.5).
    static constexpr double step = 0.1;

  private:
    double target_;
    std::vector<Known> known_;  ///< by quality
};

}  // namespace render2mpeg::app
