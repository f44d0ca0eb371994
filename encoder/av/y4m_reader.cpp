#include "encoder/av/y4m_reader.h"

#include <charconv>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace render2mpeg::av {
namespace {

using Siting = Y4mFormat::Siting;

std::optional<std::int64_t> whole_number(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc{} || end != text.data() + text.size() || value < 0) return {};
    return value;
}

/// "30000:1001". 0 in either place, with which files say that they do not know, gives nothing.
std::optional<core::Rational> ratio(std::string_view text, const std::string& file) {
    const std::size_t colon = text.find(':');
    const auto num = whole_number(text.substr(0, colon));
    const auto den = colon == std::string_view::npos ? std::nullopt : whole_number(text.substr(colon + 1));
    // chosen: the largest that anybody writes is a million; the limit keeps products of two within 64 bits.
    constexpr std::int64_t limit = 1 << 30;
    if (!num || !den || *num > limit || *den > limit)
        throw core::Error("reading", file, "the header's ratio " + std::string(text) + " is none");
    if (*num == 0 || *den == 0) return {};
    return core::Rational{*num, *den};
}

int extent(std::string_view text, const std::string& file) {
    const auto value = whole_number(text);
    // [H262, 6.3.3]: sizes have 14 bits.
    if (!value || *value < 1 || *value > 16383)
        throw core::Error("reading", file, "the header's size " + std::string(text) + " is not from 1 to 16383 pixels");
    return static_cast<int>(*value);
}

/// Reads "420jpeg", "422p10", "mono12".
void read_kind(std::string_view tag, const std::string& file, Y4mFormat& format) {
    using Chroma = Y4mFormat::Chroma;
    struct Kind {
        std::string_view name;
        Chroma chroma;
        Siting siting;
        std::string_view before_depth;  ///< what stands between the name and a depth other than 8
    };
    static constexpr Kind kinds[] = {
        {"420jpeg", Chroma::c420, Siting::jpeg, "-"},   {"420mpeg2", Chroma::c420, Siting::mpeg2, "-"},
        {"420paldv", Chroma::c420, Siting::paldv, "-"}, {"420", Chroma::c420, Siting::jpeg, "p"},
        {"422", Chroma::c422, Siting::mpeg2, "p"},      {"444", Chroma::c444, Siting::mpeg2, "p"},
        {"mono", Chroma::none, Siting::mpeg2, ""}};
    for (const Kind& kind : kinds) {
        if (!tag.starts_with(kind.name)) continue;
        std::string_view rest = tag.substr(kind.name.size());
        format.chroma = kind.chroma;
        format.siting = rest.empty() ? kind.siting : Siting::mpeg2;  // as films of more than 8 bits have it
        if (rest.empty()) return;
        if (!rest.starts_with(kind.before_depth)) break;
        rest.remove_prefix(kind.before_depth.size());
        format.depth = static_cast<int>(whole_number(rest).value_or(0));
        if (format.depth >= 9 && format.depth <= 16) return;
        break;
    }
    throw core::Error("reading", file,
                      "pictures of kind C" + std::string(tag) +
                          " are not read: expected 420, 422, 444 or mono, of 8 to 16 bits (C420jpeg, C422p10)");
}

void check_scanning(std::string_view tag, const std::string& file) {
    if (tag == "p" || tag == "?") return;
    throw core::Error("reading", file, "interlaced pictures (I" + std::string(tag) + ") are not read");
}

/// A line without its end; nothing if there is none within `longest` bytes.
std::optional<std::string> line_of(std::istream& stream, std::size_t longest) {
    std::string line;
    for (int c = stream.get(); c != '\n'; c = stream.get()) {
        if (c < 0 || line.size() >= longest) return {};
        line.push_back(static_cast<char>(c));
    }
    return line;
}

/// chosen: ffmpeg's lines are below 100 bytes; comments (X...) may lengthen them.
constexpr std::size_t longest_line = 4096;

/// Parses a stream's first line. Throws core::Error.
Y4mFormat read_header(std::istream& stream, const std::string& name) {
    Y4mFormat format;
    const auto header = line_of(stream, longest_line);
    if (!header || !(*header + " ").starts_with("YUV4MPEG2 "))
        throw core::Error("reading", name, "not a Y4M file: it does not begin with a YUV4MPEG2 header");
    std::istringstream words(header->substr(9));
    for (std::string word; words >> word;) {
        const std::string_view value = std::string_view(word).substr(1);
        switch (word[0]) {
            case 'W':
                format.width = extent(value, name);
                break;
            case 'H':
                format.height = extent(value, name);
                break;
            case 'F':
                format.hertz = ratio(value, name);
                break;
            case 'A':
                format.pixel_aspect = ratio(value, name);
                break;
            case 'I':
                check_scanning(value, name);
                break;
            case 'C':
                read_kind(value, name, format);
                break;
            case 'X':
                if (value == "COLORRANGE=FULL") format.full_range = true;
                break;
            default:
                break;  // [Y4M]: unknown parameters are to be skipped
        }
    }
    if (format.width == 0 || format.height == 0)
        throw core::Error("reading", name, "the header does not say how large the pictures are");
    return format;
}

/// Checks the line that stands before a picture; `line`: none where there was none.
void check_frame(const std::optional<std::string>& line, const std::string& name, const std::string& object) {
    if (!line || !(*line + " ").starts_with("FRAME "))
        throw core::Error("reading", name, object, "it does not begin with the word FRAME");
    // [Y4M]: streams of mixed scanning say with each frame which field comes first.
    std::istringstream words(line->substr(5));
    for (std::string word; words >> word;)
        if (word[0] == 'I' && word.find_first_of("tTbB") == 1)
            throw core::Error("reading", name, object, "interlaced pictures are not read");
}

/// Reads a picture. The stream has failed where its samples are not all there.
core::Picture read_picture(std::istream& stream, const Y4mFormat& format, core::ExactChroma chroma,
                           std::int64_t frame) {
    std::vector<std::uint8_t> bytes(bytes_of(format));
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    core::Picture picture;
    if (stream) picture = picture_of(format, bytes, chroma);
    picture.number = frame;
    return picture;
}

std::string frame_name(std::int64_t number) {
    return "frame " + std::to_string(number);
}

}  // namespace

Y4mReader::Y4mReader(const std::filesystem::path& file, core::ExactChroma chroma) : file_(file), chroma_(chroma) {
    std::error_code ignored;
    if (!std::filesystem::exists(file_, ignored)) throw core::Error("reading", file_.string(), "no such file");
    if (!std::filesystem::is_regular_file(file_, ignored)) throw core::Error("reading", file_.string(), "not a file");
    stream_.open(file_, std::ios::binary);
    if (!stream_) throw core::Error("reading", file_.string(), "cannot be opened");
    format_ = read_header(stream_, file_.string());
    find_frames();
}

void Y4mReader::find_frames() {
    const std::uint64_t size = std::filesystem::file_size(file_), frame = bytes_of(format_);
    std::uint64_t at = static_cast<std::uint64_t>(stream_.tellg());
    while (at < size) {
        const std::string object = frame_name(frames());
        check_frame(line_of(stream_, longest_line), file_.string(), object);
        const std::uint64_t first = static_cast<std::uint64_t>(stream_.tellg());
        if (size - first < frame) throw core::Error("reading", file_.string(), object, "it is cut off");
        offsets_.push_back(first);
        at = first + frame;
        stream_.seekg(static_cast<std::streamoff>(at));
    }
    if (offsets_.empty()) throw core::Error("reading", file_.string(), "it holds no pictures");
}

core::Picture Y4mReader::read(std::int64_t frame) {
    EXPECTS(frame >= 0 && frame < frames());
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(offsets_[static_cast<std::size_t>(frame)]));
    core::Picture picture = read_picture(stream_, format_, chroma_, frame);
    if (!stream_) throw core::Error("reading", file_.string(), frame_name(frame), "it cannot be read");
    return picture;
}

Y4mPipe::Y4mPipe(std::istream& stream, std::string name, core::ExactChroma chroma)
    : stream_(stream), name_(std::move(name)), format_(read_header(stream, name_)), chroma_(chroma) {}

std::optional<core::Picture> Y4mPipe::next() {
    if (stream_.peek() == std::istream::traits_type::eof()) return {};
    check_frame(line_of(stream_, longest_line), name_, frame_name(frames_));
    core::Picture picture = read_picture(stream_, format_, chroma_, frames_);
    if (!stream_) throw core::Error("reading", name_, frame_name(frames_), "it is cut off");
    ++frames_;
    return picture;
}

}  // namespace render2mpeg::av
