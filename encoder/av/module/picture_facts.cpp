#include "encoder/av/module/picture_facts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/numeric.h"

namespace render2mpeg::av {
namespace {

const AVFrameSideData* side_data(const AVFrame& frame, AVFrameSideDataType type) {
    return av_frame_get_side_data(&frame, type);
}

/// Quantisers of the macroblocks that are shown. Of MPEG-2 libavcodec tells quantiser_scale: twice the code where the
/// scale is linear.
void add_quantisers(const AVFrame& frame, double unit, PictureFacts& facts) {
    const AVFrameSideData* data = side_data(frame, AV_FRAME_DATA_VIDEO_ENC_PARAMS);
    if (data == nullptr) return;
    auto* parameters = reinterpret_cast<AVVideoEncParams*>(data->data);
    double sum = 0;
    int count = 0;
    for (unsigned int i = 0; i < parameters->nb_blocks; ++i) {
        const AVVideoBlockParams& block = *av_video_enc_params_block(parameters, i);
        if (block.src_x >= frame.width || block.src_y >= frame.height) continue;
        const double quantiser = unit * (parameters->qp + block.delta_qp);
        facts.min_quantiser = count == 0 ? quantiser : std::min(facts.min_quantiser, quantiser);
        facts.max_quantiser = std::max(facts.max_quantiser, quantiser);
        sum += quantiser;
        ++count;
    }
    facts.mean_quantiser = core::divide_or(sum, static_cast<double>(count), 0.0);
}

/// Motion vectors of a picture's macroblocks. A macroblock may have several vectors in one direction.
class Vectors {
  public:
    explicit Vectors(const AVFrame& frame)
        : columns_((frame.width + 15) / 16),
          rows_((frame.height + 15) / 16),
          forward_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
          backward_(forward_) {}

    void add(const AVMotionVector& vector) {
        // Places are those of the block's middle.
        const int column = vector.dst_x / 16, row = vector.dst_y / 16;
        if (column < 0 || column >= columns_ || row < 0 || row >= rows_) return;
        const auto at =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
        Macroblock& macroblock = (vector.source < 0 ? forward_ : backward_)[at];
        macroblock.predicted = true;
        if (vector.motion_x == 0 && vector.motion_y == 0) return;
        const double length = core::divide_or(std::hypot(vector.motion_x, vector.motion_y),
                                              static_cast<double>(vector.motion_scale), 0.0);
        macroblock.moving = true;
        (vector.source < 0 ? forward_lengths_ : backward_lengths_).push_back(length);
    }

    void tell(PictureFacts& facts) const {
        facts.forward = facts_of(forward_, forward_lengths_);
        facts.backward = facts_of(backward_, backward_lengths_);
        std::size_t intra = 0;
        for (std::size_t i = 0; i < forward_.size(); ++i)
            intra += !forward_[i].predicted && !backward_[i].predicted ? 1u : 0u;
        facts.intra = core::divide_or(static_cast<double>(intra), static_cast<double>(forward_.size()), 0.0);
    }

  private:
    struct Macroblock {
        bool predicted = false, moving = false;
    };

    static VectorFacts facts_of(const std::vector<Macroblock>& macroblocks, const std::vector<double>& lengths) {
        VectorFacts facts;
        const auto count = static_cast<double>(macroblocks.size());
        const auto share = [&](auto which) {
            return core::divide_or(static_cast<double>(std::count_if(macroblocks.begin(), macroblocks.end(), which)),
                                   count, 0.0);
        };
        facts.share = share([](const Macroblock& m) { return m.predicted; });
        facts.moving = share([](const Macroblock& m) { return m.moving; });
        for (const double length : lengths) {
            facts.mean += length;
            facts.longest = std::max(facts.longest, length);
        }
        facts.mean = core::divide_or(facts.mean, static_cast<double>(lengths.size()), 0.0);
        return facts;
    }

    int columns_, rows_;
    std::vector<Macroblock> forward_, backward_;
    std::vector<double> forward_lengths_, backward_lengths_;
};

}  // namespace

PictureFacts facts_of(const AVFrame& frame, encoder::Codec codec) {
    PictureFacts facts;
    facts.type = av_get_picture_type_char(frame.pict_type);
    facts.interlaced = is_interlaced(frame);
    facts.top_field_first = is_top_field_first(frame);
    facts.repeated_fields = frame.repeat_pict;
    add_quantisers(frame, codec == encoder::Codec::mpeg2 ? 0.5 : 1.0, facts);
    Vectors vectors(frame);
    if (const AVFrameSideData* data = side_data(frame, AV_FRAME_DATA_MOTION_VECTORS)) {
        const auto* first = reinterpret_cast<const AVMotionVector*>(data->data);
        std::for_each(first, first + data->size / sizeof(AVMotionVector),
                      [&](const AVMotionVector& vector) { vectors.add(vector); });
    }
    vectors.tell(facts);
    return facts;
}

core::Plane<encoder::MacroblockRecord> macroblocks_of(const AVFrame& frame) {
    const AVFrameSideData* data = side_data(frame, AV_FRAME_DATA_VIDEO_ENC_PARAMS);
    if (data == nullptr) return {};
    core::Plane<encoder::MacroblockRecord> records((frame.width + 15) / 16, (frame.height + 15) / 16);
    for (encoder::MacroblockRecord& record : records.values()) record.intra = true;
    const auto at = [&](int x, int y) -> encoder::MacroblockRecord* {
        const int column = x / 16, row = y / 16;
        const bool inside = x >= 0 && y >= 0 && column < records.width() && row < records.height();
        return inside ? &records.at(column, row) : nullptr;
    };
    auto* parameters = reinterpret_cast<AVVideoEncParams*>(data->data);
    for (unsigned int i = 0; i < parameters->nb_blocks; ++i) {
        const AVVideoBlockParams& block = *av_video_enc_params_block(parameters, i);
        if (encoder::MacroblockRecord* record = at(block.src_x, block.src_y))
            record->quantiser = static_cast<std::uint8_t>(std::clamp(parameters->qp + block.delta_qp, 0, 255));
    }
    if (const AVFrameSideData* vectors = side_data(frame, AV_FRAME_DATA_MOTION_VECTORS)) {
        const auto* first = reinterpret_cast<const AVMotionVector*>(vectors->data);
        std::for_each(first, first + vectors->size / sizeof(AVMotionVector), [&](const AVMotionVector& vector) {
            encoder::MacroblockRecord* record = at(vector.dst_x, vector.dst_y);
            if (record == nullptr) return;
            record->intra = false;
            (vector.source < 0 ? record->forward : record->backward) = true;
        });
    }
    return records;
}

}  // namespace render2mpeg::av
