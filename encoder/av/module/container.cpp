#include "encoder/av/module/container.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "core/error.h"
#include "encoder/av/module/ffmpeg.h"
#include "encoder/av/module/sound_track.h"
#include "encoder/codec.h"

namespace render2mpeg::av {
namespace {

/// Bytes of one pack of a program stream: a sector of a disc [H222, 2.5.3.3 leaves it open; libavformat's default].
constexpr std::int64_t pack_bytes = 2048;

/// How fast a program stream comes, in bits per second: at least what its video asks for with 5 % for headers, and fast
/// enough that the largest picture comes within one picture's time, so that no buffer ever runs dry. libavformat
/// advances the clock by whole ticks of 90 kHz per pack, cutting off fractions: take the next rate above for which
/// there are none.
int program_rate(const SequenceFacts& facts, std::int64_t sound_rate) {
    const double largest = static_cast<double>(facts.largest_picture) * 8 * facts.rate.hertz.value();
    const double needed =
        1.05 * std::max(static_cast<double>(facts.bit_rate), largest) + 10000 + 1.2 * static_cast<double>(sound_rate);
    constexpr std::int64_t unit = 50;  // program_mux_rate counts 50 bytes per second, in 22 bits [H222, 2.5.3.4]
    constexpr std::int64_t product = pack_bytes * 90000 / unit;  // of a rate in these units and a pack's ticks
    auto ticks = std::max(static_cast<std::int64_t>(static_cast<double>(product * 8 * unit) / needed), std::int64_t{1});
    while (product % ticks != 0) --ticks;
    return static_cast<int>(product / ticks * 8 * unit);
}

/// A DVD's sectors come at 10.08 Mb/s, whatever is in them; its video may take 9.8 of them. [DVDVideo]
constexpr int dvd_program_rate = 10'080'000;

/// Seconds from frame to frame at the declared rate.
AVRational frame_of(const core::FrameRate& rate) {
    return {static_cast<int>(rate.hertz.den), static_cast<int>(rate.hertz.num)};
}

class File final : public Container {
  public:
    File(const std::filesystem::path& file, const ByteSink& sink, const char* format, const encoder::Settings& settings,
         const SequenceFacts& facts, const Sound& sound)
        : file_(file.string()),
          sink_(sink),
          is_isom_(std::strcmp(format, "mp4") == 0 || std::strcmp(format, "mov") == 0),
          is_plain_program_(std::strcmp(format, "vob") == 0),
          is_dvd_(std::strcmp(format, "dvd") == 0),
          frame_(frame_of(facts.rate)),
          field_(av_mul_q(frame_, {1, 2})) {
        const Messages messages;
        AVFormatContext* context = nullptr;
        check(avformat_alloc_output_context2(&context, nullptr, format, ("file:" + file_).c_str()), messages);
        context_.reset(context);
        context->flags |= AVFMT_FLAG_BITEXACT;  // no dates, no versions, no random identifiers
        context->max_delay = 700000;  // microseconds that data may wait before its decoding: ffmpeg's own choice
        label(settings, facts, messages);
        describe_stream(settings, facts, messages);
        if (!sound.file.empty()) sound_ = std::make_unique<SoundTrack>(sound, *context, settings.codec);

        AVDictionary* options = nullptr;
        if (is_dvd_ || is_plain_program_)
            av_dict_set_int(&options, "muxrate",
                            is_dvd_ ? dvd_program_rate : program_rate(facts, sound_ ? sound_->bit_rate() : 0), 0);
        // Put the index of the pictures in front of them, so that a film plays while it is downloaded.
        if (is_isom_) av_dict_set(&options, "movflags", "+faststart", 0);
        if (sink_)
            open_sink(messages);
        else
            check(avio_open(&context->pb, ("file:" + file_).c_str(), AVIO_FLAG_WRITE), messages);
        const int result = avformat_write_header(context, &options);
        av_dict_free(&options);
        check(result, messages);
    }

    void write(const AccessUnit& unit, const Times& times, bool random_access) override {
        const Messages messages;
        const std::vector<std::uint8_t>& bytes = unit.pictures;
        EXPECTS(context_->pb != nullptr && bytes.size() < std::numeric_limits<int>::max());
        if (sound_) sound_->write_until(static_cast<double>(times.decoding) * av_q2d(field_));
        check(av_new_packet(packet_.get(), static_cast<int>(bytes.size())), messages);
        std::copy(bytes.begin(), bytes.end(), packet_->data);
        if (!unit.alpha.empty()) add_alpha(unit.alpha, messages);
        packet_->pts = times.presentation;
        packet_->dts = times.decoding;
        packet_->duration = times.duration;
        packet_->flags = random_access ? AV_PKT_FLAG_KEY : 0;
        packet_->stream_index = 0;
        av_packet_rescale_ts(packet_.get(), field_, context_->streams[0]->time_base);
        check(av_interleaved_write_frame(context_.get(), packet_.get()), messages);
        check(context_->pb->error, messages);
    }

    std::optional<Loudness> finish() override {
        const Messages messages;
        EXPECTS(context_->pb != nullptr);
        const std::optional<Loudness> loudness = sound_ ? sound_->finish() : std::nullopt;
        check(av_write_trailer(context_.get()), messages);
        // libavformat leaves out what ends a program stream [H222, 2.5.3.2: MPEG_program_end_code]. A DVD's ends with
        // its last sector.
        if (is_plain_program_) avio_wb32(context_->pb, 0x000001b9);
        avio_flush(context_->pb);
        const int error = context_->pb->error;
        const int closed = close(*context_);
        check(error, messages);
        check(closed, messages);
        return loudness;
    }

  private:
    struct Closed {
        void operator()(AVFormatContext* context) const {
            if (context->pb != nullptr) close(*context);
            avformat_free_context(context);
        }
    };

    /// As Matroska's BlockAdditional of identifier 1 [WebM, alpha].
    void add_alpha(const std::vector<std::uint8_t>& alpha, const Messages& messages) {
        constexpr int id_bytes = 8;
        std::uint8_t* data =
            av_packet_new_side_data(packet_.get(), AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL, id_bytes + alpha.size());
        if (data == nullptr) check(AVERROR(ENOMEM), messages);
        AV_WB64(data, 1);
        std::copy(alpha.begin(), alpha.end(), data + id_bytes);
    }

    static int close(AVFormatContext& context) {
        if ((context.flags & AVFMT_FLAG_CUSTOM_IO) == 0) return avio_closep(&context.pb);
        av_freep(&context.pb->buffer);
        avio_context_free(&context.pb);
        return 0;
    }

    /// libavformat passes its output to the sink, after every picture.
    void open_sink(const Messages& messages) {
        constexpr int size = 1 << 15;                                    // chosen: libavformat's own for files
        const auto hand_over = [](void* file, auto* bytes, int count) {  // constant from FFmpeg 7 on
            const ByteSink& sink = static_cast<File*>(file)->sink_;
            return sink({bytes, static_cast<std::size_t>(count)}) ? count : AVERROR(EPIPE);
        };
        auto* buffer = static_cast<unsigned char*>(av_malloc(size));
        context_->pb =
            buffer == nullptr ? nullptr : avio_alloc_context(buffer, size, 1, this, nullptr, hand_over, nullptr);
        if (context_->pb == nullptr) av_free(buffer);
        check(context_->pb == nullptr ? AVERROR(ENOMEM) : 0, messages);
        context_->flags |= AVFMT_FLAG_CUSTOM_IO | AVFMT_FLAG_FLUSH_PACKETS;
    }

    void check(int result, const Messages& messages) const {
        if (result < 0) throw core::Error("writing", file_, cause_of(result, messages));
    }

    /// Words about the film that its format keeps.
    void label(const encoder::Settings& settings, const SequenceFacts& facts, const Messages& messages) {
        const auto set = [&](const char* key, const std::string& value) {
            check(av_dict_set(&context_->metadata, key, value.c_str(), 0), messages);
        };
        const std::string& title = settings.labels.title;
        const std::string_view format = context_->oformat->name;
        if (format == "mpegts") {  // a transport stream has to name its service; others would keep tags
            set("service_provider", "render2mpeg");
            set("service_name", title.empty() ? "render2mpeg" : title);
        }
        if (!format_has_labels(format)) return;
        if (!title.empty()) set("title", title);
        if (!facts.timecode.empty()) set("timecode", facts.timecode);
        if (facts.chapters.empty()) return;
        context_->chapters = static_cast<AVChapter**>(av_calloc(facts.chapters.size(), sizeof(AVChapter*)));
        if (context_->chapters == nullptr) check(AVERROR(ENOMEM), messages);
        for (const encoder::Chapter& chapter : facts.chapters) {
            auto* added = static_cast<AVChapter*>(av_mallocz(sizeof(AVChapter)));
            if (added == nullptr) check(AVERROR(ENOMEM), messages);
            context_->chapters[context_->nb_chapters++] = added;
            added->id = context_->nb_chapters;
            added->time_base = field_;
            added->start = chapter.first;
            added->end = chapter.end;
            check(av_dict_set(&added->metadata, "title", chapter.title.c_str(), 0), messages);
        }
    }

    void describe_stream(const encoder::Settings& settings, const SequenceFacts& facts, const Messages& messages) {
        AVStream* stream = avformat_new_stream(context_.get(), nullptr);
        if (stream == nullptr || !packet_) check(AVERROR(ENOMEM), messages);
        stream->time_base = field_;
        stream->avg_frame_rate = stream->r_frame_rate = av_inv_q(frame_);
        stream->sample_aspect_ratio = {static_cast<int>(facts.pixel_aspect.num),
                                       static_cast<int>(facts.pixel_aspect.den)};

        AVCodecParameters& codec = *stream->codecpar;
        codec.codec_type = AVMEDIA_TYPE_VIDEO;
        codec.codec_id = id_of(settings.codec);
        if (settings.codec == encoder::Codec::mpeg2) codec.profile = FF_PROFILE_MPEG2_MAIN;
        if (settings.codec == encoder::Codec::dnxhr) codec.profile = FF_PROFILE_DNXHR_HQX;
        const encoder::LibraryNames& names = encoder::facts_of(settings.codec).ffmpeg;
        // With its parameter sets in the header alone HEVC is hvc1, the name that Apple's players know.
        if (is_isom_ && !names.tag.empty()) codec.codec_tag = AV_RL32(names.tag.data());
        codec.format = pixels_of(settings);
        codec.width = settings.width;
        codec.height = settings.height;
        codec.sample_aspect_ratio = stream->sample_aspect_ratio;
        codec.field_order = facts.progressive ? AV_FIELD_PROGRESSIVE : AV_FIELD_UNKNOWN;
        codec.color_range = AVCOL_RANGE_MPEG;
        codec.chroma_location = AVCHROMA_LOC_LEFT;
        // MPEG-2's numbers for these three are those of ISO/IEC 23091-2, which are FFmpeg's.
        codec.color_primaries = static_cast<AVColorPrimaries>(facts.color_primaries);
        codec.color_trc = static_cast<AVColorTransferCharacteristic>(facts.transfer_characteristics);
        codec.color_space = static_cast<AVColorSpace>(facts.matrix_coefficients);
        codec.video_delay = facts.decoding_delay;
        codec.extradata = static_cast<std::uint8_t*>(av_mallocz(facts.headers.size() + AV_INPUT_BUFFER_PADDING_SIZE));
        if (codec.extradata == nullptr) check(AVERROR(ENOMEM), messages);
        std::copy(facts.headers.begin(), facts.headers.end(), codec.extradata);
        codec.extradata_size = static_cast<int>(facts.headers.size());
        describe_buffer(*stream, facts, messages);
        if (settings.peak > 0) describe_light(*stream, settings, messages);
        if (!format_tells_immersive(context_->oformat->name)) return;
        // Boxes of MP4 that no ISO standard knows are written where one asks for them.
        const bool has_eyes = settings.packing != core::FramePacking::none;
        if (is_isom_ && (settings.sphere || has_eyes)) context_->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
        if (settings.sphere) describe_sphere(*stream, *settings.sphere, messages);
        if (settings.sphere || has_eyes) describe_eyes(*stream, settings.packing, messages);
    }

    /// Its pictures are panoramas.
    void describe_sphere(AVStream& stream, const encoder::SphereBounds& bounds, const Messages& messages) {
        std::size_t size = 0;
        AVSphericalMapping* sphere = av_spherical_alloc(&size);
        if (sphere == nullptr) check(AVERROR(ENOMEM), messages);
        const bool whole = bounds == encoder::SphereBounds();
        sphere->projection = whole ? AV_SPHERICAL_EQUIRECTANGULAR : AV_SPHERICAL_EQUIRECTANGULAR_TILE;
        const auto fixed = [](double share) { return static_cast<std::uint32_t>(std::lround(share * 0x1p32)); };
        sphere->bound_left = fixed(bounds.left);
        sphere->bound_top = fixed(bounds.top);
        sphere->bound_right = fixed(bounds.right);
        sphere->bound_bottom = fixed(bounds.bottom);
        add(stream, AV_PKT_DATA_SPHERICAL, sphere, size, messages);
    }

    /// For how many eyes its pictures are.
    void describe_eyes(AVStream& stream, core::FramePacking packing, const Messages& messages) {
        AVStereo3D* eyes = av_stereo3d_alloc();
        if (eyes == nullptr) check(AVERROR(ENOMEM), messages);
        eyes->type = packing == core::FramePacking::side_by_side ? AV_STEREO3D_SIDEBYSIDE
                     : packing == core::FramePacking::top_bottom ? AV_STEREO3D_TOPBOTTOM
                                                                 : AV_STEREO3D_2D;
        add(stream, AV_PKT_DATA_STEREO3D, eyes, sizeof *eyes, messages);
    }

    /// The display that the film is made for (library_encoder.cpp), and how bright it is.
    void describe_light(AVStream& stream, const encoder::Settings& settings, const Messages& messages) {
        AVMasteringDisplayMetadata* display = av_mastering_display_metadata_alloc();
        if (display == nullptr) check(AVERROR(ENOMEM), messages);
        constexpr int primaries[3][2] = {{32000, 16500}, {15000, 30000}, {7500, 3000}}, white[2] = {15635, 16450};
        for (int k = 0; k < 2; ++k) {
            for (int c = 0; c < 3; ++c) display->display_primaries[c][k] = {primaries[c][k], 50000};
            display->white_point[k] = {white[k], 50000};
        }
        display->has_primaries = display->has_luminance = 1;
        display->min_luminance = {1, 10000};
        display->max_luminance = {static_cast<int>(std::lround(10000 * settings.peak)), 10000};
        add(stream, AV_PKT_DATA_MASTERING_DISPLAY_METADATA, display, sizeof *display, messages);
        if (settings.light.most <= 0) return;
        std::size_t size = 0;
        AVContentLightMetadata* level = av_content_light_metadata_alloc(&size);
        if (level == nullptr) check(AVERROR(ENOMEM), messages);
        level->MaxCLL = static_cast<unsigned>(std::lround(settings.light.most));
        level->MaxFALL = static_cast<unsigned>(std::lround(settings.light.mean));
        add(stream, AV_PKT_DATA_CONTENT_LIGHT_LEVEL, level, size, messages);
    }

    /// Hands over what av_malloc() gave.
    void add(AVStream& stream, AVPacketSideDataType type, void* data, std::size_t size, const Messages& messages) {
        const int result = add_side_data(stream, type, data, size);
        if (result < 0) av_free(data);
        check(result, messages);
    }

    /// The decoder's buffer: the stream's own, but never less than two of the largest pictures, one that is being
    /// decoded and one that comes in. A DVD player's is fixed: its films must fit.
    void describe_buffer(AVStream& stream, const SequenceFacts& facts, const Messages& messages) {
        std::size_t size = 0;
        AVCPBProperties* buffer = av_cpb_properties_alloc(&size);
        if (buffer == nullptr) check(AVERROR(ENOMEM), messages);
        buffer->max_bitrate = facts.bit_rate;
        // A program stream counts it in 1024 bytes, and libavformat cuts off the rest.
        const std::int64_t bits =
            is_dvd_ ? facts.buffer_bits
                    : std::max(facts.buffer_bits, static_cast<std::int64_t>(facts.largest_picture) * 16);
        buffer->buffer_size = (bits + 8191) / 8192 * 8192;
        buffer->vbv_delay = std::numeric_limits<std::uint64_t>::max();
        add(stream, AV_PKT_DATA_CPB_PROPERTIES, buffer, size, messages);
    }

    std::string file_;
    ByteSink sink_;  ///< empty: into the file
    bool is_isom_, is_plain_program_, is_dvd_;
    AVRational frame_, field_;  ///< seconds
    std::unique_ptr<AVFormatContext, Closed> context_;
    Packet packet_{av_packet_alloc()};
    std::unique_ptr<SoundTrack> sound_;  ///< null: the film is silent
};

}  // namespace

std::unique_ptr<Container> create_container(const std::filesystem::path& file, const ByteSink& sink, const char* format,
                                            const encoder::Settings& settings, const SequenceFacts& facts,
                                            const Sound& sound) {
    return std::make_unique<File>(file, sink, format, settings, facts, sound);
}

void check_container(const std::filesystem::path& name, const char* format, encoder::Codec codec, const Sound& sound) {
    const auto refuse = [&](const std::string& what) {
        throw core::Error("writing", name.string(), "this machine's FFmpeg " + what);
    };
    if (av_guess_format(format, nullptr, nullptr) == nullptr)
        refuse("does not write such files (libavformat lacks the muxer " + std::string(format) + ")");
    if (avcodec_find_decoder(id_of(codec)) == nullptr)
        refuse(std::string("does not decode ") + avcodec_get_name(id_of(codec)) + ", which would prove the film");
    if (sound.file.empty()) return;
    AVFormatContext* context = nullptr;
    if (avformat_alloc_output_context2(&context, nullptr, format, "check") < 0) refuse("lacks memory");
    const std::unique_ptr<AVFormatContext, void (*)(AVFormatContext*)> held(context, avformat_free_context);
    Sound second = sound;
    second.seconds = 1;
    second.offset = 0;
    const SoundTrack track(second, *context, codec);
}

}  // namespace render2mpeg::av
