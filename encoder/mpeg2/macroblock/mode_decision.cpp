#include "encoder/mpeg2/macroblock/mode_decision.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/macroblock/prediction_modes.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Prediction of a skipped macroblock. Computed on first use, chroma only where luma leaves the decision open.
class SkipTrial {
  public:
    SkipTrial(const PictureCoding& picture, int column, int row, const PredictionMode* mode)
        : picture_(picture), column_(column), row_(row), mode_(mode) {}

    /// Null: it must not be skipped.
    const PredictionMode* mode() const { return mode_; }
    const Prediction& prediction() const { return prediction_; }
    /// Whether it may be skipped and that leaves no more distortion than `limit`; then prediction() is whole.
    bool leaves_at_most(float limit) {
        if (!mode_) return false;
        if (!luma_is_predicted_) {
            luma_is_predicted_ = true;
            predict_luma(picture_, column_, row_, *mode_, prediction_);
            distortion_ = luma_distortion(picture_, column_, row_, prediction_);
        }
        if (distortion_ > limit || chroma_is_predicted_) return distortion_ <= limit;
        chroma_is_predicted_ = true;
        predict_chroma(picture_, column_, row_, *mode_, prediction_);
        distortion_ += chroma_distortion(picture_, column_, row_, prediction_);
        return distortion_ <= limit;
    }
    int evaluations() const { return luma_is_predicted_ ? 1 : 0; }  ///< 16x16 differences computed

  private:
    const PictureCoding& picture_;
    int column_, row_;
    const PredictionMode* mode_;
    Prediction prediction_;
    float distortion_ = 0;  ///< of luma, and of chroma once that is predicted
    bool luma_is_predicted_ = false, chroma_is_predicted_ = false;
};

/// Decides the macroblocks of one row from left to right.
class RowDecision {
  public:
    RowDecision(const PictureCoding& picture, int row, const std::uint8_t* quantisers,
                const BestVectors* const (&vectors)[2])
        : picture_(picture),
          row_(row),
          quantisers_(quantisers),
          vectors_{vectors[0], vectors[1]},
          state_(picture.dc_bits, quantisers[0]),
          inter_(std::make_unique<ModeTrial>()),
          other_(std::make_unique<ModeTrial>()),
          intra_(std::make_unique<ModeTrial>()) {
        code_.quantiser = quantisers[0];
    }

    RowCode run() {
        const int columns = picture_.source.columns();
        code_.macroblocks.reserve(static_cast<std::size_t>(columns));
        for (int column = 0; column < columns; ++column) {
            // A slice begins and ends with a coded macroblock. [H262, 6.3.17]
            const bool may_skip = column > 0 && column < columns - 1;
            SkipTrial skip(picture_, column, row_, may_skip ? skip_mode(picture_, column, row_, state_) : nullptr);
            decide(column, skip);
            code_.evaluations += static_cast<std::uint64_t>(skip.evaluations());
        }
        return std::move(code_);
    }

  private:
    /// The decision on one macroblock, by J = distortion + lambda * bits. It is reconstructed at once: the next ones
    /// are predicted from its vectors.
    void decide(int column, SkipTrial& skip) {
        const int quantiser = quantisers_[column];
        const float lambda = lambda_of(picture_, quantiser);
        const Force forced = picture_.forced ? picture_.forced->at(column, row_) : Force::none;
        const bool intra_due = picture_.intra_due && picture_.intra_due->at(column, row_) != 0;

        // Apply forced modes.
        if (picture_.type == PictureType::intra || forced == Force::intra) {
            try_intra(picture_, column, row_, quantiser, state_, *intra_);
            return keep(column, *intra_);
        }
        if (forced == Force::skip && skip.leaves_at_most(std::numeric_limits<float>::max()))
            return keep_skipped(column, skip);

        // Skip at once where that leaves next to nothing (Effort::fast).
        const float next_to_nothing = skip_fast * static_cast<float>(quantiser * quantiser);
        if (picture_.fast_search && !intra_due && skip.leaves_at_most(next_to_nothing))
            return keep_skipped(column, skip);

        // Predict and quantise in the likeliest inter modes.
        if (picture_.fast_search) {
            const auto found = picture_.fast_search->best_mode(column, row_, state_.mode.vector, inter_->prediction.y);
            code_.evaluations += static_cast<std::uint64_t>(found.evaluations);
            code_.searches += static_cast<std::uint64_t>(found.searches);
            try_inter(picture_, column, row_, found.mode, quantiser, state_, *inter_, found.luma_is_predicted);
        } else {
            try_inter_modes(column, quantiser, lambda);
        }
        const float address = lambda * static_cast<float>(address_increment_bits(state_.skipped));
        const float inter_cost = inter_->rd.cost(lambda) + address + lambda * to_go(column, inter_->mode);
        const float intra_to_go = lambda * to_go(column, PredictionMode{{}, {false, false}});

        // Try intra where it is due or may win.
        bool intra = intra_due;
        if (intra_due || intra_may_win(column, inter_cost, lambda)) {
            try_intra(picture_, column, row_, quantiser, state_, *intra_);
            intra = intra_due || intra_->rd.cost(lambda) + address + intra_to_go < inter_cost;
        }

        // Choose: skip where that costs no more. It makes the next address increment longer.
        const float best = intra ? intra_->rd.cost(lambda) + intra_to_go : inter_cost;
        const float skip_bits = static_cast<float>(address_increment_bits(state_.skipped + 1)) +
                                (skip.mode() ? to_go(column, *skip.mode()) : 0.0f);
        if (skip.leaves_at_most(best - lambda * skip_bits))
            keep_skipped(column, skip);
        else
            keep(column, intra ? *intra_ : *inter_);
    }

    /// Effort::quality: leaves the best of the likeliest inter modes in inter_.
    void try_inter_modes(int column, int quantiser, float lambda) {
        float least = std::numeric_limits<float>::max();
        const auto try_mode = [&](const PredictionMode& mode) {
            try_inter(picture_, column, row_, mode, quantiser, state_, *other_);
            const float cost = other_->rd.cost(lambda) + lambda * to_go(column, mode);
            if (cost >= least) return;
            least = cost;
            std::swap(inter_, other_);
        };
        const BestVectors& forward = vectors_[0][column];
        if (picture_.type == PictureType::predicted) {
            for (int i = 0; i < forward.count; ++i) try_mode({{forward.vector[i], {}}, {true, false}});
            return;
        }
        const ModeChoice choice = choose_prediction_modes(picture_, column, row_, state_, forward, vectors_[1][column],
                                                          lambda_motion * static_cast<float>(quantiser));
        code_.evaluations += static_cast<std::uint64_t>(choice.evaluations);
        for (const PredictionMode& mode : choice.modes) try_mode(mode);
    }

    /// Bits behind this macroblock, by the vectors that it leaves in a mode.
    float to_go(int column, const PredictionMode& mode) const {
        const auto of = [&](int d) { return vectors_[d] ? &vectors_[d][column].to_go : nullptr; };
        return cost_to_go(picture_, state_, mode, {of(0), of(1)});
    }

    /// Intra costs at least its type, six DC sizes and six ends of block, and its distortion is hardly below what
    /// quantisation leaves of the block's own activity.
    bool intra_may_win(int column, float inter_cost, float lambda) {
        const int least_bits = picture_.effort == Effort::fast ? intra_bits_fast : 5 + 6 * 2 + 6 * 2;
        if (inter_cost <= lambda * static_cast<float>(least_bits)) return false;
        const Kernels& k = kernels();
        const auto stride = static_cast<std::ptrdiff_t>(picture_.source.y.width());
        const std::uint8_t* here = picture_.source.y.row(row_ * 16) + column * 16;
        ++code_.evaluations;
        return static_cast<float>(k.activity_16x16(here, stride)) <
               intra_activity_limit * static_cast<float>(k.satd_16x16(here, stride, inter_->prediction.y, 16));
    }

    void keep_skipped(int column, const SkipTrial& skip) {
        reconstruct_skipped(picture_, column, row_, skip.prediction());
        MacroblockCode code;
        code.skipped = true;
        code.mode = *skip.mode();
        code.quantiser = static_cast<std::uint8_t>(state_.quantiser);
        append(code);
    }

    /// Adopts a trial, made coarser where it would exceed the limit of bits.
    void keep(int column, ModeTrial& trial) {
        const int components = 2 * (trial.mode.uses[0] + trial.mode.uses[1]);  // none in intra macroblocks
        const int limit = static_cast<int>(macroblock_bits_limit) - address_increment_bits(state_.skipped) -
                          components * f_code_margin;
        while (largest(trial) > limit && trial.quantiser < 31) requantise(column, trial, trial.quantiser + 1);
        if (largest(trial) > limit) truncate_to(trial, picture_, state_, limit);

        MacroblockCode code;
        code.type = trial.rd.type;
        code.pattern = static_cast<std::uint8_t>(trial.rd.pattern);
        const bool quantised = code.type.intra || code.type.pattern;
        code.quantiser = static_cast<std::uint8_t>(quantised ? trial.quantiser : state_.quantiser);
        code.mode = trial.mode;
        for (std::size_t i = 0; i < 6; ++i) {
            const Block& block = trial.block[i];
            code.dc[i] = static_cast<std::uint16_t>(code.type.intra ? block.dc : 0);
            if ((code.pattern & (32 >> i)) == 0) continue;
            const std::size_t before = code_.runs.size();
            append_runs(block, code_.runs, code.type.intra);
            code.runs[i] = static_cast<std::uint8_t>(code_.runs.size() - before);
        }
        code_.table_one_gain += trial.rd.bits - trial.rd.bits_with_one;
        reconstruct(picture_, column, row_, trial);
        append(code);
    }

    void requantise(int column, ModeTrial& trial, int quantiser) {
        if (trial.rd.type.intra) return try_intra(picture_, column, row_, quantiser, state_, trial);
        const PredictionMode mode = trial.mode;
        try_inter(picture_, column, row_, mode, quantiser, state_, trial);
    }

    static int largest(const ModeTrial& trial) { return std::max(trial.rd.bits, trial.rd.bits_with_one); }

    void append(const MacroblockCode& code) {
        advance(state_, code);
        code_.macroblocks.push_back(code);
    }

    const PictureCoding& picture_;
    int row_;
    const std::uint8_t* quantisers_;
    const BestVectors* vectors_[2];
    SliceState state_;
    std::unique_ptr<ModeTrial> inter_, other_, intra_;
    RowCode code_;
};

}  // namespace

RowCode decide_row(const PictureCoding& picture, int row, const std::uint8_t* quantisers,
                   const BestVectors* const (&vectors)[2]) {
    return RowDecision(picture, row, quantisers, vectors).run();
}

}  // namespace render2mpeg::encoder::mpeg2
