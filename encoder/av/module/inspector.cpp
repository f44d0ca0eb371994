#include "encoder/av/module/inspector.h"

#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.h"
#include "encoder/av/module/ffmpeg.h"
#include "encoder/av/module/input.h"
#include "encoder/av/module/picture_facts.h"

namespace render2mpeg::av {
namespace {

/// The codec of a stream, of several of one kind the one that its container names; none: films are not made with it.
std::optional<encoder::Codec> codec_of(const AVCodecParameters& stream) {
    std::optional<encoder::Codec> found;
    for (const encoder::CodecFacts& facts : encoder::all_codecs) {
        const std::string_view tag = facts.ffmpeg.tag;
        const bool named = !tag.empty() && stream.codec_tag == AV_RL32(tag.data());
        if (id_of(facts.codec) == stream.codec_id && (!found || named)) found = facts.codec;
    }
    return found;
}

/// A level that is told as whole and tenth: 31 is "3.1".
std::string tenths(int level) {
    const std::string text = std::to_string(level);
    return level < 10 ? text : text.substr(0, text.size() - 1) + "." + text.back();
}

/// Level codes of profile_and_level_indication [H262, table 8-3], level_idc [H264, A.3.1], thirtieths of a level [H265,
/// A.4.1], or seq_level_idx [AV1, A.3].
std::string level_name(encoder::Codec codec, int level) {
    if (level <= 0 || encoder::facts_of(codec).master) return {};
    if (codec == encoder::Codec::h264) return tenths(level);
    if (codec == encoder::Codec::hevc) return tenths(level / 3);
    if (codec == encoder::Codec::av1) return tenths(20 + 10 * (level / 4) + level % 4);
    switch (level) {
        case 4:
            return "High";
        case 6:
            return "High-1440";
        case 8:
            return "Main";
        case 10:
            return "Low";
        default:
            return {};
    }
}

core::Rational rational(AVRational r) {
    return r.num > 0 && r.den > 0 ? core::Rational{r.num, r.den} : core::Rational{0, 1};
}

/// Whether decoding can begin with an access unit; in MPEG-2: it begins with a sequence header or a GOP's.
bool is_random_access(encoder::Codec codec, const AVPacket& packet) {
    if (codec != encoder::Codec::mpeg2) return (packet.flags & AV_PKT_FLAG_KEY) != 0;
    const std::uint8_t* d = packet.data;
    return packet.size >= 4 && d[0] == 0 && d[1] == 0 && d[2] == 1 && (d[3] == 0xb3 || d[3] == 0xb8);
}

/// libavcodec's words without the name of the part that says them: "[mpeg2video] ac-tex damaged at 3 4".
std::string without_prefix(const std::string& text) {
    const std::size_t end = text.starts_with("[") ? text.find("] ") : std::string::npos;
    return end == std::string::npos ? text : text.substr(end + 2);
}

/// One film being looked at.
class InspectedFilm {
  public:
    explicit InspectedFilm(const std::filesystem::path& file)
        : file_(file.string()), film_(open_film(file_, AV_EF_CRCCHECK, messages_)) {
        open_decoder();
    }

    Inspection inspect() {
        int result = 0;
        while ((result = av_read_frame(film_.input.get(), packet_.get())) >= 0) {
            if (packet_->stream_index == film_.stream->index) send(packet_.get());
            av_packet_unref(packet_.get());
        }
        if (result != AVERROR_EOF) result_.damage.push_back("reading ended early: " + cause_of(result, messages_));
        send(nullptr);
        finish();
        return std::move(result_);
    }

  private:
    /// Facts about a coded picture before decoding.
    struct Coded {
        std::int64_t bytes = 0, position = -1;
        bool random_access = false;
        bool shown = false;
        std::string damage;
    };

    [[noreturn]] void refuse(const std::string& cause) const { throw core::Error("reading", file_, cause); }

    void open_decoder() {
        const AVCodecID kind = film_.stream->codecpar->codec_id;
        const std::optional<encoder::Codec> known = codec_of(*film_.stream->codecpar);
        if (!known) {
            std::string all;
            for (const encoder::CodecFacts& facts : encoder::all_codecs)
                if (all.find(facts.ffmpeg.stream) == std::string::npos)
                    all += (all.empty() ? "" : ", ") + std::string(facts.ffmpeg.stream);
            refuse(std::string("its video is ") + avcodec_get_name(kind) + ", not " + all);
        }
        codec_ = *known;
        const AVCodec* codec = avcodec_find_decoder(kind);
        if (codec == nullptr) refuse(std::string("libavcodec has no decoder for ") + avcodec_get_name(kind));
        decoder_.reset(avcodec_alloc_context3(codec));
        if (!decoder_ || !packet_ || !frame_) refuse(cause_of(AVERROR(ENOMEM), messages_));
        avcodec_parameters_to_context(decoder_.get(), film_.stream->codecpar);
        // Hand over every picture as soon as it is decoded: at the end of MPEG-2 libavcodec tells nothing of the last
        // one.
        if (codec_ == encoder::Codec::mpeg2) decoder_->flags |= AV_CODEC_FLAG_LOW_DELAY;
        decoder_->export_side_data = AV_CODEC_EXPORT_DATA_MVS | AV_CODEC_EXPORT_DATA_VIDEO_ENC_PARAMS;
        decoder_->thread_count = 1;
        number_frames(*decoder_);
        if (const int r = avcodec_open2(decoder_.get(), codec, nullptr); r < 0) refuse(cause_of(r, messages_));
    }

    /// Decodes one access unit; null: flushes the decoder.
    void send(AVPacket* packet) {
        const Messages messages;  // messages from now on concern this picture
        if (packet != nullptr) {
            set_number(*decoder_, *packet, static_cast<std::int64_t>(coded_.size()));
            coded_.push_back({packet->size, packet->pos, is_random_access(codec_, *packet), false, {}});
            if (packet->flags & AV_PKT_FLAG_CORRUPT) coded_.back().damage = "the container marks it as damaged";
        }
        int result = avcodec_send_packet(decoder_.get(), packet);
        bool damaged = result < 0 && result != AVERROR_EOF;
        while ((result = avcodec_receive_frame(decoder_.get(), frame_.get())) >= 0) show();
        damaged = damaged || (result != AVERROR(EAGAIN) && result != AVERROR_EOF) || messages.has_error();
        if (!damaged || coded_.empty() || !coded_.back().damage.empty()) return;
        coded_.back().damage =
            messages.text().empty() ? "libavcodec cannot decode it" : without_prefix(messages.text());
    }

    void show() {
        PictureFacts facts = facts_of(*frame_, codec_);
        facts.coded = number_of(*frame_);
        if (frame_->flags & AV_FRAME_FLAG_CORRUPT) facts.damage = "libavcodec marks it as damaged";
        if (frame_->decode_error_flags != 0) facts.damage = "parts of it are missing or broken";
        if (result_.pictures.empty()) read_group_time();
        result_.pictures.push_back(facts);
    }

    /// Of MPEG-2's first group, where it is not midnight, which may stand for none.
    void read_group_time() {
        const AVFrameSideData* data = av_frame_get_side_data(frame_.get(), AV_FRAME_DATA_GOP_TIMECODE);
        if (data == nullptr || data->size < sizeof(std::int64_t)) return;
        std::int64_t packed = 0;
        std::memcpy(&packed, data->data, sizeof packed);
        std::array<char, AV_TIMECODE_STR_SIZE> text{};
        av_timecode_make_mpeg_tc_string(text.data(), static_cast<std::uint32_t>(packed));
        if (std::string_view(text.data()).find_first_not_of("0:;") != std::string_view::npos) group_time_ = text.data();
    }

    /// Pictures of MPEG-2 come as they were coded: an I or P picture is shown when the next one comes, a B picture at
    /// once. Others come as they are shown.
    void sort_for_display() {
        std::vector<PictureFacts> shown;
        std::optional<PictureFacts> waiting;
        for (const PictureFacts& picture : result_.pictures) {
            if (codec_ != encoder::Codec::mpeg2 || picture.type == 'B') {
                shown.push_back(picture);
            } else {
                if (waiting) shown.push_back(*waiting);
                waiting = picture;
            }
        }
        if (waiting) shown.push_back(*waiting);
        for (std::size_t i = 0; i < shown.size(); ++i) shown[i].number = static_cast<std::int64_t>(i);
        result_.pictures = std::move(shown);
    }

    /// Combines the facts from before and after decoding.
    void finish() {
        sort_for_display();
        for (PictureFacts& picture : result_.pictures) {
            if (picture.coded < 0 || picture.coded >= static_cast<std::int64_t>(coded_.size())) continue;
            Coded& coded = coded_[static_cast<std::size_t>(picture.coded)];
            coded.shown = true;
            picture.bytes = coded.bytes;
            picture.position = coded.position;
            picture.random_access = coded.random_access;
            if (!coded.damage.empty()) picture.damage = coded.damage;
        }
        for (std::size_t i = 0; i < coded_.size(); ++i) {
            if (coded_[i].shown) continue;
            ++result_.unshown;
            if (!coded_[i].damage.empty())
                result_.damage.push_back("coded picture " + std::to_string(i) + ": " + coded_[i].damage);
        }
        const AVCodecParameters& parameters = *film_.stream->codecpar;
        const char* profile = avcodec_profile_name(parameters.codec_id, decoder_->profile);
        StreamFacts& s = result_.stream;
        s.container =
            film_.input->iformat->long_name != nullptr ? film_.input->iformat->long_name : film_.input->iformat->name;
        s.streams = static_cast<int>(film_.input->nb_streams);
        s.profile = profile != nullptr ? profile : "";
        s.codec = codec_;
        s.level = level_name(codec_, decoder_->level);
        s.width = decoder_->width > 0 ? decoder_->width : parameters.width;
        s.height = decoder_->height > 0 ? decoder_->height : parameters.height;
        s.rate = rational(codec_ == encoder::Codec::mpeg2 ? decoder_->framerate : film_.stream->avg_frame_rate);
        s.pixel_aspect = rational(decoder_->sample_aspect_ratio);
        // Damaged streams have numbers that libavcodec's enumerations lack.
        const auto number = [](const auto& value, int unspecified) {
            int is = 0;
            std::memcpy(&is, &value, sizeof is);
            return is == unspecified ? 0 : is;
        };
        s.color_primaries = number(decoder_->color_primaries, AVCOL_PRI_UNSPECIFIED);
        s.matrix_coefficients = number(decoder_->colorspace, AVCOL_SPC_UNSPECIFIED);
        s.transfer_characteristics = number(decoder_->color_trc, AVCOL_TRC_UNSPECIFIED);
        if (const auto* display =
                side_data_of<AVMasteringDisplayMetadata>(*film_.stream, AV_PKT_DATA_MASTERING_DISPLAY_METADATA);
            display != nullptr && display->has_luminance != 0 && display->max_luminance.den != 0)
            s.peak = av_q2d(display->max_luminance);
        if (const auto* level = side_data_of<AVContentLightMetadata>(*film_.stream, AV_PKT_DATA_CONTENT_LIGHT_LEVEL))
            s.light = {static_cast<float>(level->MaxCLL), static_cast<float>(level->MaxFALL)};
        if (const auto* sphere = side_data_of<AVSphericalMapping>(*film_.stream, AV_PKT_DATA_SPHERICAL);
            sphere != nullptr && (sphere->projection == AV_SPHERICAL_EQUIRECTANGULAR ||
                                  sphere->projection == AV_SPHERICAL_EQUIRECTANGULAR_TILE))
            s.sphere = {sphere->bound_left * 0x1p-32, sphere->bound_top * 0x1p-32, sphere->bound_right * 0x1p-32,
                        sphere->bound_bottom * 0x1p-32};
        if (const auto* eyes = side_data_of<AVStereo3D>(*film_.stream, AV_PKT_DATA_STEREO3D)) {
            if (eyes->type == AV_STEREO3D_SIDEBYSIDE) s.packing = core::FramePacking::side_by_side;
            if (eyes->type == AV_STEREO3D_TOPBOTTOM) s.packing = core::FramePacking::top_bottom;
        }
        read_labels(s);
        s.bit_rate = decoder_->rc_max_rate;
        s.buffer_bits = decoder_->rc_buffer_size;
    }

    void read_labels(StreamFacts& s) const {
        const auto tag = [](const AVDictionary* tags, const char* name) -> std::string {
            const AVDictionaryEntry* entry = av_dict_get(tags, name, nullptr, 0);
            return entry == nullptr ? "" : entry->value;
        };
        s.title = tag(film_.input->metadata, "title");
        // A transport stream's is its service's name, which is the writer's own where there is none.
        for (unsigned i = 0; i < film_.input->nb_programs && s.title.empty(); ++i) {
            const std::string name = tag(film_.input->programs[i]->metadata, "service_name");
            if (name != "Service01" && name != "render2mpeg") s.title = name;
        }
        s.timecode = tag(film_.input->metadata, "timecode");
        if (s.timecode.empty()) s.timecode = tag(film_.stream->metadata, "timecode");
        if (s.timecode.empty()) s.timecode = group_time_;
        s.chapters = static_cast<int>(film_.input->nb_chapters);
    }

    std::string file_;
    Messages messages_;
    OpenStream film_;
    encoder::Codec codec_ = encoder::Codec::mpeg2;
    Decoder decoder_;
    Packet packet_{av_packet_alloc()};
    Frame frame_{av_frame_alloc()};
    std::vector<Coded> coded_;
    std::string group_time_;
    Inspection result_;
};

}  // namespace

Inspection inspect_film(const std::filesystem::path& file) {
    return InspectedFilm(file).inspect();
}

}  // namespace render2mpeg::av
