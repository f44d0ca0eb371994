#include "encoder/mpeg2/macroblock/row_coding.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/syntax.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/macroblock/prediction_modes.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// Decides the macroblocks of one row from left to right.
class RowDecider {
  public:
    RowDecider(const PictureCoding& picture, int row, const std::uint8_t* quantisers)
        : picture_(picture),
          row_(row),
          quantisers_(quantisers),
          inter_(std::make_unique<ModeTrial>()),
          other_(std::make_unique<ModeTrial>()),
          intra_(std::make_unique<ModeTrial>()) {
        code_.quantiser = quantisers[0];
        state_ = SliceState(picture.dc_bits, quantisers[0]);
    }

    RowCode run(const BestVectors* const (&vectors)[2]) {
        const int columns = picture_.source.columns();
        code_.macroblocks.reserve(static_cast<std::size_t>(columns));
        for (int column = 0; column < columns; ++column) {
            quantiser_ = quantisers_[column];
            lambda_ = picture_.lambda_factor * static_cast<float>(quantiser_ * quantiser_);
            // A slice begins and ends with a coded macroblock. [H262, 6.3.17]
            const bool may_skip = column > 0 && column < columns - 1;
            if (apply_forced_mode(column, may_skip)) continue;
            if (picture_.type == PictureType::intra) {
                try_intra(picture_, column, row_, quantiser_, state_, *intra_);
                keep(column, *intra_);
            } else if (picture_.fast_search) {
                if (skip_at_once(column, may_skip)) continue;
                fast_mode_decision(column);
                settle(column, may_skip);
            } else if (picture_.type == PictureType::predicted) {
                try_vectors(column, vectors[0][column]);
                settle(column, may_skip);
            } else {
                try_modes(column, vectors[0][column], vectors[1][column]);
                settle(column, may_skip);
            }
        }
        return std::move(code_);
    }

  private:
    /// Codes a macroblock as it is forced to be; false: it is not, or cannot be.
    bool apply_forced_mode(int column, bool may_skip) {
        const Force force = picture_.forced ? picture_.forced->at(column, row_) : Force::none;
        if (force == Force::intra) {
            try_intra(picture_, column, row_, quantiser_, state_, *intra_);
            keep(column, *intra_);
            return true;
        }
        if (force == Force::none || !may_skip) return false;
        const PredictionMode* skipped = skip_mode(picture_, column, row_, state_);
        if (!skipped) return false;
        skip_leaves_at_most(std::numeric_limits<float>::max(), column, *skipped);
        skip(column, *skipped);
        return true;
    }

    /// Effort::fast: skips a macroblock that this leaves next to nothing of.
    bool skip_at_once(int column, bool may_skip) {
        if (!may_skip || (picture_.intra_due && picture_.intra_due->at(column, row_) != 0)) return false;
        const PredictionMode* skipped = skip_mode(picture_, column, row_, state_);
        const float limit = skip_fast * static_cast<float>(quantiser_ * quantiser_);
        if (!skipped || !skip_leaves_at_most(limit, column, *skipped)) return false;
        skip(column, *skipped);
        return true;
    }

    /// Effort::fast: leaves in inter_ what Hadamard sums call the best mode.
    void fast_mode_decision(int column) {
        const FastMotionSearch& fast_search = *picture_.fast_search;
        const bool bidirectional = picture_.type == PictureType::bidirectional;
        FastMotionSearch::Found found[2];
        for (int d = 0; d < (bidirectional ? 2 : 1); ++d)
            found[d] = fast_search.begin(d, column, row_, state_.mode.vector[d]);

        // Of two directions the mean is most often the best; where it is good enough nothing more is tried.
        std::uint32_t difference = 0;
        const auto take_mean = [&] {
            difference =
                fast_search.difference_of_mean(column, row_, found[0].vector, found[1].vector, inter_->prediction.y);
            ++code_.evaluations;
        };
        if (bidirectional) take_mean();
        if (!bidirectional || !fast_search.is_enough(difference)) {
            const Vector before[2] = {found[0].vector, found[1].vector};
            for (int d = 0; d < (bidirectional ? 2 : 1); ++d)
                fast_search.refine(found[d], d, column, row_, state_.mode.vector[d]);
            if (bidirectional && (found[0].vector != before[0] || found[1].vector != before[1])) take_mean();
        }

        // The mean's samples are still there.
        PredictionMode mode{{found[0].vector, {}}, {true, false}};
        bool luma_is_predicted = false;
        if (bidirectional) {
            const FastMotionSearch::Found &first = found[0], &second = found[1];
            const float bits = first.cost + second.cost - static_cast<float>(first.difference + second.difference);
            const float mean = static_cast<float>(difference) + bits;
            luma_is_predicted = mean <= first.cost && mean <= second.cost;
            if (luma_is_predicted)
                mode = {{first.vector, second.vector}, {true, true}};
            else if (second.cost < first.cost)
                mode = {{{}, second.vector}, {false, true}};
        }
        code_.evaluations += static_cast<std::uint64_t>(found[0].evaluations + found[1].evaluations);
        try_inter(picture_, column, row_, mode, quantiser_, state_, *inter_, luma_is_predicted);
    }

    /// Chooses between inter_, intra and skipping.
    void settle(int column, bool may_skip) {
        const float inter =
            inter_->rd.cost(lambda_) + lambda_ * static_cast<float>(address_increment_bits(state_.skipped));
        const bool due = picture_.intra_due && picture_.intra_due->at(column, row_) != 0;
        if (due) try_intra(picture_, column, row_, quantiser_, state_, *intra_);
        const bool intra = due || (intra_may_win(column, inter) && intra_wins(column, inter));
        const float best = intra ? intra_->rd.cost(lambda_) : inter;
        const PredictionMode* skipped = may_skip ? skip_mode(picture_, column, row_, state_) : nullptr;
        // Skipping makes the next address increment longer.
        const float limit = best - lambda_ * static_cast<float>(address_increment_bits(state_.skipped + 1));
        if (skipped && skip_leaves_at_most(limit, column, *skipped)) {
            skip(column, *skipped);
        } else {
            keep(column, intra ? *intra_ : *inter_);
        }
    }

    /// Leaves the best of the vectors in inter_.
    void try_vectors(int column, const BestVectors& vectors) {
        try_inter(picture_, column, row_, {{vectors.vector[0], {}}, {true, false}}, quantiser_, state_, *inter_);
        for (int i = 1; i < tried(vectors.count); ++i) try_also(column, {{vectors.vector[i], {}}, {true, false}});
    }

    /// Of `count` modes within reach of the best.
    int tried(int count) const { return picture_.effort == Effort::quality ? count : 1; }

    void try_also(int column, const PredictionMode& mode) {
        try_inter(picture_, column, row_, mode, quantiser_, state_, *other_);
        if (other_->rd.cost(lambda_) < inter_->rd.cost(lambda_)) std::swap(inter_, other_);
    }

    /// Likewise in a B picture.
    void try_modes(int column, const BestVectors& forward, const BestVectors& backward) {
        const ModeChoice choice = choose_prediction_modes(picture_, column, row_, state_, forward, backward,
                                                          lambda_motion * static_cast<float>(quantiser_));
        code_.evaluations += static_cast<std::uint64_t>(choice.evaluations);
        try_inter(picture_, column, row_, choice.mode[0], quantiser_, state_, *inter_);
        for (int i = 1; i < tried(choice.count); ++i) try_also(column, choice.mode[i]);
    }

    /// Whether skipping leaves no more distortion than `limit`; if so, prediction_ has what is shown then. Chroma is
    /// looked at only where luma leaves that open. A macroblock may ask twice.
    bool skip_leaves_at_most(float limit, int column, const PredictionMode& mode) {
        if (predicted_column_ != column) {
            predicted_column_ = column;
            chroma_is_predicted_ = false;
            ++code_.evaluations;
            predict_luma(picture_, column, row_, mode, prediction_);
            skip_distortion_ = luma_distortion(picture_, column, row_, prediction_);
        }
        if (skip_distortion_ > limit || chroma_is_predicted_) return skip_distortion_ <= limit;
        chroma_is_predicted_ = true;
        predict_chroma(picture_, column, row_, mode, prediction_);
        skip_distortion_ += chroma_distortion(picture_, column, row_, prediction_);
        return skip_distortion_ <= limit;
    }

    /// Intra costs at least its type, six DC sizes and six ends of block, and its distortion is hardly below what
    /// quantisation leaves of the block's own activity.
    bool intra_may_win(int column, float inter_cost) {
        const int least_bits = picture_.effort == Effort::fast ? intra_bits_fast : 5 + 6 * 2 + 6 * 2;
        if (inter_cost <= lambda_ * least_bits) return false;
        const Kernels& k = kernels();
        const auto stride = static_cast<std::ptrdiff_t>(picture_.source.y.width());
        const std::uint8_t* here = picture_.source.y.row(row_ * 16) + column * 16;
        ++code_.evaluations;
        return static_cast<float>(k.activity_16x16(here, stride)) <
               intra_activity_limit * static_cast<float>(k.satd_16x16(here, stride, inter_->prediction.y, 16));
    }

    bool intra_wins(int column, float inter_cost) {
        try_intra(picture_, column, row_, quantiser_, state_, *intra_);
        return intra_->rd.cost(lambda_) + lambda_ * static_cast<float>(address_increment_bits(state_.skipped)) <
               inter_cost;
    }

    void skip(int column, const PredictionMode& mode) {
        reconstruct_skipped(picture_, column, row_, prediction_);
        MacroblockCode code;
        code.skipped = true;
        code.mode = mode;
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
        if (trial.rd.type.intra) {
            try_intra(picture_, column, row_, quantiser, state_, trial);
        } else {
            const PredictionMode mode = trial.mode;
            try_inter(picture_, column, row_, mode, quantiser, state_, trial);
        }
    }

    static int largest(const ModeTrial& trial) { return std::max(trial.rd.bits, trial.rd.bits_with_one); }

    void append(const MacroblockCode& code) {
        advance(state_, code);
        code_.macroblocks.push_back(code);
    }

    const PictureCoding& picture_;
    int row_;
    const std::uint8_t* quantisers_;
    int quantiser_ = 1;  ///< of the macroblock
    float lambda_ = 0;
    SliceState state_;
    std::unique_ptr<ModeTrial> inter_, other_, intra_;
    Prediction prediction_;      ///< of the macroblock in predicted_column_ if it is skipped
    int predicted_column_ = -1;  ///< -1: none yet
    bool chroma_is_predicted_ = false;
    float skip_distortion_ = 0;  ///< of luma, and of chroma once that is predicted
    RowCode code_;
};

void write_address_increment(BitWriter& out, int increment) {
    for (; increment > 33; increment -= 33) out.put(address_increment_codes[0]);
    out.put(address_increment_codes[static_cast<std::size_t>(increment)]);
}

/// Writes one coded macroblock; gives the runs after its own.
const RunLevel* write_macroblock(BitWriter& out, const RowSyntax& syntax, const SliceState& state,
                                 const MacroblockCode& code, const RunLevel* runs) {
    write_address_increment(out, state.skipped + 1);
    out.put(macroblock_type_code(syntax.type, code.type));
    if (code.type.quant) out.put(code.quantiser, 5);
    for (int d = 0; d < 2; ++d) {
        if (!code.type.motion(d)) continue;
        const Vector v = code.mode.vector[d], before = state.mode.vector[d];
        write_component(out, v.x - before.x, syntax.f_code[d][0]);
        write_component(out, v.y - before.y, syntax.f_code[d][1]);
    }
    if (code.type.pattern) out.put(pattern_codes[code.pattern]);
    const bool one = code.type.intra && syntax.intra_vlc_format;
    const CoefficientCodes& codes = one ? coefficient_codes_one() : coefficient_codes_zero();
    int dc[3] = {state.dc[0], state.dc[1], state.dc[2]};
    for (int i = 0; i < 6; ++i) {
        if ((code.pattern & (32 >> i)) == 0) continue;
        if (code.type.intra) {
            const int plane = i < 4 ? 0 : i - 3;
            write_dc(out, code.dc[i] - dc[plane], plane == 0);
            dc[plane] = code.dc[i];
        }
        write_coefficients(out, runs, code.runs[i], codes, code.type.intra);
        runs += code.runs[i];
    }
    return runs;
}

}  // namespace

RowCode decide_row(const PictureCoding& picture, int row, const std::uint8_t* quantisers,
                   const BestVectors* const (&vectors)[2]) {
    return RowDecider(picture, row, quantisers).run(vectors);
}

void write_row(BitWriter& out, const RowSyntax& syntax, RowCode& code) {
    write_slice_header(out, syntax.lines, syntax.row, syntax.quantiser);
    SliceState state(syntax.dc_bits, syntax.quantiser);
    const RunLevel* runs = code.runs.data();
    for (MacroblockCode& macroblock : code.macroblocks) {
        const std::size_t before = out.bit_count();
        if (!macroblock.skipped) runs = write_macroblock(out, syntax, state, macroblock, runs);
        macroblock.bits = static_cast<std::uint32_t>(out.bit_count() - before);
        advance(state, macroblock);
    }
    out.align();
}

}  // namespace render2mpeg::encoder::mpeg2
