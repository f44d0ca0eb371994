#include "encoder/av/module/library_encoder.h"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <limits>
#include <string>
#include <utility>

#include "core/error.h"
#include "encoder/av/module/ffmpeg.h"
#include "encoder/av/module/picture_copy.h"
#include "encoder/av/module/picture_facts.h"
#include "encoder/codec.h"

namespace render2mpeg::av {
namespace {

const char* library_of(encoder::Codec codec) {
    return encoder::facts_of(codec).ffmpeg.encoder.data();
}

constexpr const char* lost_alpha = "this machine's drops alpha; choose --codec prores4444, or --transparent off";

const AVCodec& encoder_for(encoder::Codec codec) {
    const AVCodec* found = avcodec_find_encoder_by_name(library_of(codec));
    if (found == nullptr)
        throw core::Error("coding with", library_of(codec),
                          "this machine's libavcodec does not have it; install " +
                              std::string(encoder::facts_of(codec).ffmpeg.package) + ", or choose --codec mpeg2");
    return *found;
}

const AVCodec& decoder_for(encoder::Codec codec) {
    const AVCodec* found = codec == encoder::Codec::av1 ? avcodec_find_decoder_by_name("libdav1d") : nullptr;
    if (found == nullptr) found = avcodec_find_decoder(id_of(codec));
    if (found == nullptr)
        throw core::Error("coding with", library_of(codec), "this machine's libavcodec has no decoder for it");
    return *found;
}

/// Display that the film is made for: BT.709's colours, which are all that a renderer of three channels has, black as
/// dark as PQ's first code values, white. [CTA861, annex P] in x265's units, 0.00002 and 0.0001 cd/m^2.
std::string mastering_x265(const encoder::Settings& settings) {
    if (settings.peak <= 0) return {};
    return ":master-display=G(15000,30000)B(7500,3000)R(32000,16500)WP(15635,16450)L(" +
           std::to_string(std::lround(10000 * settings.peak)) + ",1)";
}
/// The same in SVT-AV1's.
std::string mastering_svt(const encoder::Settings& settings) {
    if (settings.peak <= 0) return {};
    return ":mastering-display=G(0.3,0.6)B(0.15,0.06)R(0.64,0.33)WP(0.3127,0.329)L(" +
           std::to_string(std::lround(settings.peak)) + ",0.0001)";
}

/// Quantisers are as asked for, whatever else these settings do: complexity counts nothing, no picture is looked at
/// ahead, types make no difference. Adaptive quantisation is on, else offsets are ignored, but next to nothing.
std::string x264_settings(const encoder::Settings& settings) {
    // Its numbers are those of frame_packing_arrangement_type [H264, table D-8].
    const char* packing = settings.packing == core::FramePacking::side_by_side ? ":frame-packing=3"
                          : settings.packing == core::FramePacking::top_bottom ? ":frame-packing=4"
                                                                               : "";
    return "qcomp=1:aq-mode=1:aq-strength=0.0001:mbtree=0:rc-lookahead=0:sync-lookahead=0:force-cfr=1:"
           "ipratio=1:pbratio=1:scenecut=0:keyint=infinite:b-adapt=0:b-pyramid=normal:open-gop=0:no-psy=1:level=" +
           std::to_string(settings.level) + ":ref=" + std::to_string(settings.references) + packing;
}

/// The same of x265. Blocks of 32x32 have a quantiser: those of 16x16 cost more bits than they save. All sizes of
/// blocks are tried (rskip), which saves 5 % of bits for a third more time (docs/measurements.md#codecs). The lowest
/// level is declared: x265 takes no other with known quantisers.
std::string x265_settings(const encoder::Settings& settings) {
    return "qcomp=1:aq-mode=1:aq-strength=0.0001:qg-size=32:cutree=0:ipratio=1:pbratio=1:scenecut=0:keyint=-1:"
           "b-adapt=0:b-pyramid=1:open-gop=0:rc-lookahead=" +
           std::to_string(settings.b_pictures + 1) + mastering_x265(settings) +
           (settings.effort == encoder::Effort::fast ? "" : ":rskip=0") +
           ":lookahead-slices=0:frame-threads=1:pools=none:wpp=0:info=0:log-level=error:psy-rd=0:psy-rdoq=0";
}

/// Layers have these offsets alone (1), blocks what it finds by what is predicted from them. chosen: restoration is
/// off, which takes 0.5 % of bits (docs/measurements.md#codecs).
std::string svt_settings(const encoder::Settings& settings, const IndexOffsets& offsets) {
    std::string all = "lp=1:scd=0:keyint=-1:irefresh-type=2:enable-restoration=0" + mastering_svt(settings);
    if (settings.level > 0) all += ":level=" + std::to_string(settings.level);
    all += ":use-fixed-qindex-offsets=1:key-frame-qindex-offset=" + std::to_string(offsets[0]) + ":qindex-offsets=";
    for (std::size_t i = 1; i < offsets.size(); ++i) all += (i == 1 ? "[" : ",") + std::to_string(offsets[i]);
    return all + "]";
}

AVPictureType type_of(encoder::PictureType type) {
    if (type == encoder::PictureType::intra) return AV_PICTURE_TYPE_I;
    return type == encoder::PictureType::predicted ? AV_PICTURE_TYPE_P : AV_PICTURE_TYPE_B;
}

encoder::PictureType type_of(AVPictureType type) {
    if (type == AV_PICTURE_TYPE_I) return encoder::PictureType::intra;
    return type == AV_PICTURE_TYPE_B ? encoder::PictureType::bidirectional : encoder::PictureType::predicted;
}

AVRational pixel_aspect(const encoder::Settings& settings) {
    return {static_cast<int>(settings.pixel_aspect.num), static_cast<int>(settings.pixel_aspect.den)};
}

/// While it lives, memory that is handed out holds the same bytes whatever was there before: x265 reads some that it
/// never wrote, and films must not depend on it.
class SameMemory {
  public:
    explicit SameMemory(encoder::Codec codec) : on_(codec == encoder::Codec::hevc) { set(85); }
    ~SameMemory() { set(0); }
    SameMemory(const SameMemory&) = delete;
    SameMemory& operator=(const SameMemory&) = delete;

  private:
    void set([[maybe_unused]] int byte) const {
#ifdef M_PERTURB
        if (on_) mallopt(M_PERTURB, byte);
#endif
    }
    bool on_;
};

/// An encoder with its decoder.
class Library final : public LibraryEncoder {
  public:
    Library(const encoder::Settings& settings, const IndexOffsets& offsets) : settings_(settings), offsets_(offsets) {
        const Messages messages;
        if (!packet_ || !frame_ || !shown_) check(AVERROR(ENOMEM), messages);
        {
            const SameMemory same(settings.codec);
            open_encoder(messages);
        }
        open_decoder(messages);
    }

    const std::vector<std::uint8_t>& headers() const override { return headers_; }

    void send(const core::Picture& picture, const LibraryOrder& order) override {
        const Messages messages;
        const SameMemory same(settings_.codec);
        av_frame_unref(frame_.get());
        frame_->format = encoder_->pix_fmt;
        frame_->width = encoder_->width;
        frame_->height = encoder_->height;
        check(av_frame_get_buffer(frame_.get(), 0), messages);
        fill(*frame_, picture);
        frame_->pts = picture.number;
        // ProRes has its colours from here.
        frame_->color_primaries = encoder_->color_primaries;
        frame_->color_trc = encoder_->color_trc;
        frame_->colorspace = encoder_->colorspace;
        frame_->color_range = encoder_->color_range;
        // SVT-AV1 orders its pictures by itself.
        frame_->pict_type = settings_.codec == encoder::Codec::av1 ? AV_PICTURE_TYPE_NONE : type_of(order.type);
        if (encoder::facts_of(settings_.codec).takes_blocks) add_offsets(order.quantisers, messages);
        check(avcodec_send_frame(encoder_.get(), frame_.get()), messages);
        receive(messages);
    }

    void end() override {
        const Messages messages;
        const SameMemory same(settings_.codec);
        check(avcodec_send_frame(encoder_.get(), nullptr), messages);
        receive(messages);
        check(avcodec_send_packet(decoder_.get(), nullptr), messages);
        show(messages);
    }

    std::vector<LibraryPicture> take() override {
        std::vector<LibraryPicture> complete;
        while (!waiting_.empty() && waiting_.front().shown) {
            complete.push_back(std::move(waiting_.front().picture));
            waiting_.pop_front();
        }
        return complete;
    }

  private:
    struct Waiting {
        LibraryPicture picture;
        bool shown = false;
    };

    void check(int result, const Messages& messages) const {
        if (result < 0) throw core::Error("coding with", library_of(settings_.codec), cause_of(result, messages));
    }

    void open_encoder(const Messages& messages) {
        const AVCodec& codec = encoder_for(settings_.codec);
        encoder_.reset(avcodec_alloc_context3(&codec));
        if (!encoder_) check(AVERROR(ENOMEM), messages);
        // It speaks on the terminal, whatever libavcodec is told, unless it is told not to.
        if (settings_.codec == encoder::Codec::av1) setenv("SVT_LOG", "0", 0);
        AVCodecContext& e = *encoder_;
        e.width = settings_.width;
        e.height = settings_.height;
        const AVPixelFormat wanted = pixels_of(settings_);
        const bool is_master = encoder::facts_of(settings_.codec).master;
        e.pix_fmt = is_master || takes(codec, wanted) ? wanted : AV_PIX_FMT_YUV420P;
        if (settings_.color_primaries == AVCOL_PRI_BT2020 && e.pix_fmt == AV_PIX_FMT_YUV420P)
            throw core::Error("coding with", library_of(settings_.codec),
                              "this machine's takes 8 bits alone, high dynamic range needs 10");
        e.framerate = {static_cast<int>(settings_.rate.hertz.num), static_cast<int>(settings_.rate.hertz.den)};
        e.time_base = av_inv_q(e.framerate);
        e.sample_aspect_ratio = pixel_aspect(settings_);
        e.color_range = AVCOL_RANGE_MPEG;
        // MPEG-2's numbers for these are FFmpeg's.
        e.color_primaries = static_cast<AVColorPrimaries>(settings_.color_primaries);
        e.color_trc = static_cast<AVColorTransferCharacteristic>(settings_.transfer_characteristics);
        e.colorspace = static_cast<AVColorSpace>(settings_.matrix_coefficients);
        e.chroma_sample_location = AVCHROMA_LOC_LEFT;
        e.max_b_frames = settings_.b_pictures;
        e.gop_size = is_master ? 1 : std::numeric_limits<int>::max();
        e.thread_count = 1;  // with more of them, bytes would be others
        e.flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_CLOSED_GOP;
        AVDictionary* options = library_options();
        const int result = avcodec_open2(&e, &codec, &options);
        av_dict_free(&options);
        check(result, messages);
        headers_.assign(e.extradata, e.extradata + e.extradata_size);
    }

    AVDictionary* library_options() const {
        AVDictionary* options = nullptr;
        const encoder::LibraryNames& names = encoder::facts_of(settings_.codec).ffmpeg;
        const bool fast = settings_.effort == encoder::Effort::fast;
        av_dict_set(&options, names.choice.data(), (fast ? names.fast : names.quality).data(), 0);
        if (settings_.codec == encoder::Codec::h264_lossless) av_dict_set_int(&options, "qp", 0, 0);
        if (encoder::facts_of(settings_.codec).master) return options;
        if (settings_.codec == encoder::Codec::av1) {
            av_dict_set_int(&options, "crf", settings_.quantiser, 0);
            av_dict_set(&options, "svtav1-params", svt_settings(settings_, offsets_).c_str(), 0);
            return options;
        }
        if (settings_.codec == encoder::Codec::vp9) {
            add_vpx_options(options);
            return options;
        }
        av_dict_set_int(&options, "forced-idr", 1, 0);
        av_dict_set_int(&options, "crf", settings_.quantiser, 0);
        if (settings_.codec == encoder::Codec::hevc) {
            av_dict_set(&options, "x265-params", x265_settings(settings_).c_str(), 0);
        } else {
            av_dict_set(&options, "x264-params", x264_settings(settings_).c_str(), 0);
        }
        return options;
    }

    /// All pictures have the quantiser that they are told: key pictures and golden ones would be finer by what libvpx
    /// finds, and of references that are never shown it makes none beside alpha.
    void add_vpx_options(AVDictionary*& options) const {
        for (const char* name : {"crf", "qmin", "qmax"}) av_dict_set_int(&options, name, settings_.quantiser, 0);
        for (const char* name : {"b", "auto-alt-ref", "lag-in-frames", "aq-mode", "row-mt"})
            av_dict_set_int(&options, name, 0, 0);
    }

    void open_decoder(const Messages& messages) {
        const AVCodec& codec = decoder_for(settings_.codec);
        decoder_.reset(avcodec_alloc_context3(&codec));
        const Parameters parameters(avcodec_parameters_alloc());
        if (!decoder_ || !parameters) check(AVERROR(ENOMEM), messages);
        check(avcodec_parameters_from_context(parameters.get(), encoder_.get()), messages);
        check(avcodec_parameters_to_context(decoder_.get(), parameters.get()), messages);
        decoder_->thread_count = 1;
        decoder_->export_side_data = AV_CODEC_EXPORT_DATA_MVS | AV_CODEC_EXPORT_DATA_VIDEO_ENC_PARAMS;
        check(avcodec_open2(decoder_.get(), &codec, nullptr), messages);
    }

    /// Tells x264 or x265 what each macroblock's quantiser is to be, run by run. Of regions that overlap the first one
    /// counts; these do not.
    void add_offsets(const core::Plane<std::uint8_t>& quantisers, const Messages& messages) {
        constexpr int range = 51;  // libavcodec's unit: all of the scale
        std::vector<AVRegionOfInterest> regions;
        for (int row = 0; row < quantisers.height(); ++row)
            for (int column = 0; column < quantisers.width();) {
                const int first = column, quantiser = quantisers.at(column, row);
                while (column < quantisers.width() && quantisers.at(column, row) == quantiser) ++column;
                AVRegionOfInterest region{};
                region.self_size = sizeof region;
                region.top = 16 * row;
                region.bottom = std::min(16 * row + 16, settings_.height);
                region.left = 16 * first;
                region.right = std::min(16 * column, settings_.width);
                region.qoffset = {quantiser - settings_.quantiser, range};
                regions.push_back(region);
            }
        // Every picture has some: x265 crashes where one has and another before it had none.
        const std::size_t bytes = regions.size() * sizeof(AVRegionOfInterest);
        AVFrameSideData* data = av_frame_new_side_data(frame_.get(), AV_FRAME_DATA_REGIONS_OF_INTEREST, bytes);
        if (data == nullptr) check(AVERROR(ENOMEM), messages);
        std::memcpy(data->data, regions.data(), bytes);
    }

    /// Takes finished packets from the encoder, and passes them to the decoder.
    void receive(const Messages& messages) {
        while (true) {
            const int result = avcodec_receive_packet(encoder_.get(), packet_.get());
            if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
            check(result, messages);
            LibraryPicture picture;
            picture.number = packet_->pts;
            picture.bytes.assign(packet_->data, packet_->data + packet_->size);
            if (settings_.alpha && settings_.codec == encoder::Codec::vp9) picture.alpha = alpha_of(*packet_);
            waiting_.push_back({std::move(picture)});
            check(avcodec_send_packet(decoder_.get(), packet_.get()), messages);
            av_packet_unref(packet_.get());
            show(messages);
        }
    }

    /// Alpha's own stream, behind eight bytes of Matroska.
    std::vector<std::uint8_t> alpha_of(const AVPacket& packet) const {
        std::size_t size = 0;
        const std::uint8_t* data = av_packet_get_side_data(&packet, AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL, &size);
        if (data == nullptr || size <= 8) throw core::Error("coding with", library_of(settings_.codec), lost_alpha);
        return {data + 8, data + size};
    }

    void show(const Messages& messages) {
        while (true) {
            const int result = avcodec_receive_frame(decoder_.get(), shown_.get());
            if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
            check(result, messages);
            const auto found = std::find_if(waiting_.begin(), waiting_.end(),
                                            [&](const Waiting& w) { return w.picture.number == shown_->pts; });
            EXPECTS(found != waiting_.end());
            LibraryPicture& picture = found->picture;
            picture.type = type_of(shown_->pict_type);
            picture.reconstruction = picture_of(*shown_, picture.number);
            // VP9's decoder tells a quantiser, and no macroblocks.
            if (encoder::facts_of(settings_.codec).tells_blocks) picture.macroblocks = macroblocks_of(*shown_);
            found->shown = true;
        }
    }

    using Parameters = std::unique_ptr<AVCodecParameters, Freed<AVCodecParameters, avcodec_parameters_free>>;

    const encoder::Settings settings_;
    const IndexOffsets offsets_;
    Decoder encoder_, decoder_;
    Packet packet_{av_packet_alloc()};
    Frame frame_{av_frame_alloc()}, shown_{av_frame_alloc()};
    std::vector<std::uint8_t> headers_;
    std::deque<Waiting> waiting_;  ///< in coding order
};

}  // namespace

void check_library_encoder(const encoder::Settings& settings) {
    const AVCodec& codec = encoder_for(settings.codec);
    if (settings.alpha && settings.codec == encoder::Codec::vp9 && !takes(codec, pixels_of(settings)))
        throw core::Error("coding with", library_of(settings.codec), lost_alpha);
    decoder_for(settings.codec);
}

std::unique_ptr<LibraryEncoder> open_library_encoder(const encoder::Settings& settings, const IndexOffsets& offsets) {
    return std::make_unique<Library>(settings, offsets);
}

}  // namespace render2mpeg::av
