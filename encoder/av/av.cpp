#include "encoder/av/av.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/module.h"
#include "core/text.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/backend.h"
#include "encoder/av/gif_codes.h"
#include "encoder/av/inspect.h"
#include "encoder/cadence.h"
#include "encoder/codec.h"
#include "encoder/timecode.h"

namespace render2mpeg::av {
namespace {

/// Endings and libavformat's names. Its own guess for .mpg is MPEG-1's system stream.
constexpr std::array<std::pair<std::string_view, const char*>, 10> formats{{{".mpg", "vob"},
                                                                            {".mpeg", "vob"},
                                                                            {".vob", "vob"},
                                                                            {".ts", "mpegts"},
                                                                            {".m2v", "mpeg2video"},
                                                                            {".mkv", "matroska"},
                                                                            {".webm", "webm"},
                                                                            {".gif", "gif"},
                                                                            {".mp4", "mp4"},
                                                                            {".mov", "mov"}}};

/// Whether a container keeps a stream's headers apart from its pictures. Decoders of MPEG-2 and AV1 want both.
bool keeps_headers_apart(std::string_view format, encoder::Codec codec) {
    if (!has_byte_stream(codec)) return true;
    return (codec == encoder::Codec::h264 || codec == encoder::Codec::hevc) &&
           (format == "matroska" || format == "mp4" || format == "mov");
}

/// Sequence facts of a stream, from its first picture.
SequenceFacts sequence_of(const encoder::Settings& settings, std::span<const std::uint8_t> picture) {
    if (settings.codec == encoder::Codec::mpeg2) return read_sequence(picture);
    SequenceFacts facts;
    facts.headers = taken_apart(settings.codec, picture).headers;
    facts.width = settings.width;
    facts.height = settings.height;
    facts.pixel_aspect = settings.pixel_aspect;
    facts.rate = settings.rate;
    facts.progressive = true;
    // B pictures that others refer to stand in the middle of two or more (encoder/codec.h).
    facts.decoding_delay = std::min(settings.b_pictures, 2);
    facts.color_primaries = settings.color_primaries;
    facts.transfer_characteristics = settings.transfer_characteristics;
    facts.matrix_coefficients = settings.matrix_coefficients;
    return facts;
}

/// The film's labels as containers take them.
void label(SequenceFacts& facts, const encoder::Settings& settings, std::string_view format) {
    const encoder::Labels& labels = settings.labels;
    // Editors count from the clock time of the first picture.
    if (labels.start || (format == "mov" && encoder::facts_of(settings.codec).master))
        facts.timecode = text_of(labels.start.value_or(encoder::Timecode()));
    for (const encoder::Chapter& chapter : labels.chapters)
        facts.chapters.push_back({encoder::fields_before(settings.cadence, chapter.first),
                                  encoder::fields_before(settings.cadence, chapter.end), chapter.title});
}

/// Null where the ending is none of ours.
const char* format_of(const std::filesystem::path& name) {
    const std::string ending = core::ending_of(name);
    for (const auto& [known, format] : formats)
        if (ending == known) return format;
    return nullptr;
}

/// The same; throws core::Error instead.
const char* container_of(const std::filesystem::path& name, ProgramStream program_stream) {
    const char* format = format_of(name);
    if (format == nullptr)
        throw core::Error("writing", name.string(),
                          "its ending is none of mpg, mpeg, vob, ts, m2v, mkv, webm, mp4, mov, gif");
    return std::string_view(format) == "vob" && program_stream == ProgramStream::dvd ? "dvd" : format;
}

/// A film of GIF: its pictures one behind the other.
class GifFile final : public Container {
  public:
    GifFile(const std::filesystem::path& file, const std::vector<std::uint8_t>& header)
        : name_(file.string()), stream_(file, std::ios::binary | std::ios::trunc) {
        put(header);
    }
    void write(const AccessUnit& unit, const Times&, bool) override { put(unit.pictures); }
    std::optional<Loudness> finish() override {
        put({gif_trailer});
        stream_.close();
        check();
        return {};
    }

  private:
    void put(const std::vector<std::uint8_t>& bytes) {
        stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        check();
    }
    void check() const {
        if (!stream_) throw core::Error("writing", name_, "the disk is full, or failed");
    }
    std::string name_;
    std::ofstream stream_;
};

}  // namespace

void check_container(const std::filesystem::path& name, encoder::Codec codec) {
    const encoder::CodecFacts& facts = encoder::facts_of(codec);
    if (facts.has_ending(core::ending_of(name))) return;
    const std::size_t first = facts.endings.find(' '), second = facts.endings.find(' ', first + 1);
    const std::string usual(facts.endings.substr(0, first));
    const bool alone = first == std::string_view::npos;
    throw core::Error(
        "writing", name.string(),
        "such files have no " + std::string(facts.name) + "; " + usual +
            (alone ? " has" : " and " + std::string(facts.endings.substr(first + 1, second - first - 1)) + " have"));
}

const Backend& backend() {
    static const Backend* const backend = core::module_function<const Backend*()>("av", "render2mpeg_av_backend")();
    return *backend;
}

void open_libraries() {
    backend();
}

void check_film(const std::filesystem::path& name, encoder::Codec codec, const Sound& sound,
                ProgramStream program_stream) {
    backend().check_film(name, container_of(name, program_stream), codec, sound);
}

bool can_have_sound(const std::filesystem::path& film) {
    const char* format = format_of(film);
    return format != nullptr && std::string_view(format) != "mpeg2video" && std::string_view(format) != "gif";
}

int channels_of_sound(const std::filesystem::path& file) {
    return backend().channels_of_sound(file);
}

bool is_film(const std::filesystem::path& file) {
    return format_of(file) != nullptr;
}

bool tells_immersive(const std::filesystem::path& name) {
    const char* format = format_of(name);
    return format != nullptr && format_tells_immersive(format);
}

bool can_have_chapters(const std::filesystem::path& name) {
    const char* format = format_of(name);
    return format != nullptr && format_has_labels(format);
}

bool can_have_title(const std::filesystem::path& name) {
    const char* format = format_of(name);
    return can_have_chapters(name) || (format != nullptr && std::string_view(format) == "mpegts");
}

bool can_have_timecode(const std::filesystem::path& name, encoder::Codec codec) {
    return can_have_chapters(name) || codec == encoder::Codec::mpeg2;
}

struct Muxer::Impl {
    std::filesystem::path file;
    ByteSink sink;  ///< empty: into the file
    const char* format = nullptr;
    encoder::Settings settings;
    std::size_t largest_picture = 0;
    Sound sound;
    /// Created with the first picture, whose headers the container needs.
    std::unique_ptr<Container> container;
    std::int64_t decoding_delay = 0;  ///< pictures between decoding and showing
};

Muxer::Muxer(const std::filesystem::path& file, const std::filesystem::path& name, const encoder::Settings& settings,
             std::size_t largest_picture, ProgramStream program_stream, const Sound& sound)
    : impl_(std::make_unique<Impl>()) {
    const char* format = container_of(name, program_stream);
    check_container(name, settings.codec);
    // Open the module and the file now, so that a film that cannot be written fails before it is rendered.
    backend();
    if (!std::ofstream(file, std::ios::binary | std::ios::trunc))
        throw core::Error("writing", file.string(), "cannot create the file");
    if (!sound.file.empty() && !can_have_sound(name))
        throw core::Error("writing", name.string(),
                          "such a film has no sound; .mpg, .ts, .mkv, .webm, .mp4 and .mov have");
    *impl_ = {file, {}, format, settings, largest_picture, sound, nullptr, 0};
}

Muxer::Muxer(ByteSink sink, const std::filesystem::path& name, const encoder::Settings& settings, const Sound& sound)
    : impl_(std::make_unique<Impl>()) {
    const char* format = format_of(name);
    EXPECTS(sink && format != nullptr && (std::string_view(format) == "mpegts" || !can_have_sound(name)));
    backend();
    *impl_ = {"a stream", std::move(sink), format, settings, 0, sound, nullptr, 0};
}

Muxer::~Muxer() = default;

void Muxer::write(std::span<const std::uint8_t> bytes, std::int64_t display_number, std::int64_t coding_order,
                  bool starts_gop) {
    if (!impl_->container) {
        SequenceFacts facts = sequence_of(impl_->settings, bytes);
        if (facts.width != impl_->settings.width || facts.height != impl_->settings.height)
            throw core::Error("writing", impl_->file.string(), "pictures of another size");
        // Without the film's largest picture, take twice the first one's size: an I picture, and those are the large
        // ones.
        facts.largest_picture = impl_->largest_picture > 0 ? impl_->largest_picture : 2 * bytes.size();
        impl_->decoding_delay = facts.decoding_delay;
        label(facts, impl_->settings, impl_->format);
        if (impl_->settings.codec == encoder::Codec::gif)
            impl_->container = std::make_unique<GifFile>(impl_->file, facts.headers);
        else
            impl_->container =
                backend().create(impl_->file, impl_->sink, impl_->format, impl_->settings, facts, impl_->sound);
    }
    // A picture is decoded when the one before it in display order begins to be shown (encoder/cadence.h).
    const std::int64_t decoding = coding_order - impl_->decoding_delay;
    if (decoding > display_number) throw core::Error("writing", impl_->file.string(), "pictures out of order");
    const auto fields = [&](std::int64_t number) { return encoder::fields_before(impl_->settings.cadence, number); };
    const std::int64_t presentation = fields(display_number);
    const Times times{presentation, fields(decoding), fields(display_number + 1) - presentation};
    if (keeps_headers_apart(impl_->format, impl_->settings.codec))
        impl_->container->write(taken_apart(impl_->settings.codec, bytes), times, starts_gop);
    else
        impl_->container->write({{}, {bytes.begin(), bytes.end()}, {}}, times, starts_gop);
}

std::optional<Loudness> Muxer::finish() {
    if (!impl_->container) throw core::Error("writing", impl_->file.string(), "there are no pictures to write");
    return impl_->container->finish();
}

void decode(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture) {
    backend().decode(file, picture);
}

Inspection inspect(const std::filesystem::path& file) {
    return backend().inspect(file);
}

}  // namespace render2mpeg::av
